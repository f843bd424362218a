//! Every hard case has its right answer.

use photonvdb::validate::{Verdict, hard_cases};

#[test]
fn hard_cases_have_their_right_answers() {
    let report = hard_cases().unwrap();
    for row in report.rows.iter().filter(|row| row.verdict != Verdict::Pass) {
        println!("{row:?}");
    }
    assert!(report.passes());
    let mut groups: Vec<&str> = report.rows.iter().map(|row| row.group).collect();
    groups.dedup();
    assert_eq!(
        groups,
        [
            "sigma_t -> 0",
            "sigma_t = 1e4",
            "albedo 0 and 1",
            "exp underflow, log 0",
            "g = +1, -1",
            "|g| < 1e-4",
            "negative g",
            "query on a photon",
            "identical photons",
            "k > photons",
            "scale 1e-6, 1e6",
            "far from the origin",
            "bounds without volume",
            "camera inside",
            "extreme voxels",
            "NaN, infinite, negative densities",
            "rays on faces, edges, corners",
            "axis-parallel rays, 0 and -0",
            "endless rays",
            "light on a voxel corner",
            "needle spots",
            "1e9 powers of 1e-9",
        ]
    );
}
