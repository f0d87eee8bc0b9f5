//! Tests of the hypervolume: it is compared with counted cells and with closed forms.

use super::*;
use proptest::prelude::*;

/// Number of unit cells below the reference that at least one point covers.
fn counted(points: &[[u8; 3]], reference: u8) -> u32 {
    let cells = 0..reference;
    let covered = |cell: [u8; 3]| points.iter().any(|p| (0..3).all(|k| p[k] <= cell[k]));
    let mut count = 0;
    for a in cells.clone() {
        for b in cells.clone() {
            count += cells.clone().filter(|&c| covered([a, b, c])).count() as u32;
        }
    }
    count
}

proptest! {
    #[test]
    fn it_is_the_number_of_cells_covered(points in prop::collection::vec([0u8..9, 0u8..9, 0u8..9], 0..40)) {
        let numbers: Vec<[f64; 3]> = points.iter().map(|p| p.map(f64::from)).collect();
        prop_assert_eq!(hypervolume(&numbers, [7.0; 3]).unwrap(), f64::from(counted(&points, 7)));
    }

    #[test]
    fn it_does_not_depend_on_which_objective_is_swept(
        points in prop::collection::vec([-1.0f64..1.0, -1.0f64..1.0, -1.0f64..1.0], 0..60)
    ) {
        let turned: Vec<[f64; 3]> = points.iter().map(|&[a, b, c]| [c, a, b]).collect();
        let (one, other) = (
            hypervolume(&points, [0.9, 0.8, 0.7]).unwrap(),
            hypervolume(&turned, [0.7, 0.9, 0.8]).unwrap(),
        );
        prop_assert!((one - other).abs() <= 1e-14 * one, "{} {}", one, other);
    }
}

#[test]
fn no_point_and_one_point() {
    assert_eq!(hypervolume(&[], [1.0; 3]).unwrap(), 0.0);
    assert_eq!(hypervolume(&[[1.0, 2.0, 3.0]], [2.0, 4.0, 6.0]).unwrap(), 6.0);
    assert_eq!(hypervolume(&[[1.0, 2.0, 3.0]], [2.0, 2.0, 6.0]).unwrap(), 0.0);
}

#[test]
fn a_design_that_halves_an_objective_adds_the_same_whichever_it_is() {
    let design = |kg: f64, mm: f64, hz: f64| Objectives {
        tip_deflection_m: mm / 1e3,
        mass_kg: kg,
        lowest_mode_hz: hz,
    };
    let one = |o: Objectives| front_hypervolume([o].into_iter());
    let cube = one(design(100.0, 10.0, 1.0));
    assert!((cube - libm::log(10f64).powi(3)).abs() < 1e-12);
    for better in [design(50.0, 10.0, 1.0), design(100.0, 5.0, 1.0), design(100.0, 10.0, 2.0)] {
        assert!((one(better) / cube - libm::log(20f64) / libm::log(10f64)).abs() < 1e-12);
    }
    assert_eq!(one(design(100.0, 10.0, f64::INFINITY)), 0.0);
}

#[test]
fn what_is_not_a_number_is_refused() {
    assert_eq!(hypervolume(&[[1.0, f64::NAN, 3.0]], [2.0; 3]), Err(NotANumber { point: 0 }));
}
