//! Emission: from lights to photons on their way.

pub mod aim;
mod sobol;
mod strata;
/// How photons are sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmissionKind {
    /// Independent random numbers.
    Random,
    /// One photon a stratum of direction or position and first free flight together.
    Stratified,
    /// Owen-scrambled Sobol points.
    Sobol,
}
