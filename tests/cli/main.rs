//! The program, run as its users do.

mod bake;
mod bias;
mod compare;
mod convert;
mod flags;
mod inspect;
mod manners;
mod new;
mod outputs;
mod reference;
mod render;
mod resume;
mod run;
mod sweep;
