//! Bounds on the tangent compliance of a joint between two torques.

use crate::arm::joint_law::{Curve, JointLaw};

/// Relative margin within which a torque counts as being at a break point, because of rounding.
const ROUNDING: f64 = 1e-12;

/// Least and greatest tangent compliance of a joint with the law `law` \[rad/(N m)\], under torques in the interval
/// `torque_nm`.
pub(super) fn tangent_range(law: &JointLaw, torque_nm: [f64; 2]) -> [f64; 2] {
    let size = size_range(torque_nm);
    let curve = curve_range(&law.curve, size);
    // The tangent compliance of lost motion decreases as the torque grows.
    let play = law
        .lost_motion
        .map_or([0.0; 2], |lost| [size[1], size[0]].map(|t| lost.tangent_compliance_rad_per_nm(t)));
    [0, 1].map(|end| curve[end] + law.connection_rad_per_nm + play[end])
}

/// Least and greatest secant compliance of a joint \[rad/(N m)\] between any two torques of the interval `torque_nm`.
/// The torque is taken to have risen from zero. Friction then reduces the gear's twist, by at most the half width of
/// the hysteresis.
pub(super) fn rising_range(law: &JointLaw, torque_nm: [f64; 2]) -> [f64; 2] {
    let [least, most] = tangent_range(&as_it_twists(law), torque_nm);
    let Some(stiffness) = law.play_stiffness_nm_per_rad() else { return [least, most] };
    let [near, far] = size_range(torque_nm);
    let reach = stiffness * law.hysteresis_rad;
    let held_back = if near <= reach { 1.0 / stiffness } else { 0.0 };
    let freed = if far < reach { 1.0 / stiffness } else { 0.0 };
    [least - held_back, most - freed]
}

/// The joint law `law` with the torsion curve that is used for static twist. A gear whose vibration is computed with
/// its first slope alone still has all three segments in static twist.
fn as_it_twists(law: &JointLaw) -> JointLaw {
    let curve = match law.curve {
        Curve::WindupK1(windup) => Curve::Windup(windup),
        other => other,
    };
    JointLaw { curve, ..*law }
}

/// Least and greatest magnitude of a torque in an interval \[N m\], widened by the margin for rounding.
fn size_range([low, high]: [f64; 2]) -> [f64; 2] {
    [low.max(-high).max(0.0) * (1.0 - ROUNDING), high.max(-low) * (1.0 + ROUNDING)]
}

/// Least and greatest tangent compliance of a torsion curve at torque magnitudes in an interval \[rad/(N m)\].
fn curve_range(curve: &Curve, [near, far]: [f64; 2]) -> [f64; 2] {
    match curve {
        Curve::Rigid => [0.0; 2],
        Curve::Linear(stiffness) => [1.0 / stiffness; 2],
        Curve::WindupK1(w) => [1.0 / w.k1_nm_per_rad; 2],
        Curve::Windup(w) => {
            let met = w.segments().into_iter().filter(|s| near <= s.to_nm && far >= s.from_nm);
            met.fold([f64::INFINITY, 0.0], |[least, most], s| {
                let compliance = 1.0 / s.stiffness_nm_per_rad;
                [least.min(compliance), most.max(compliance)]
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::joint_law::{LostMotion, Windup};
    use proptest::prelude::*;

    fn law() -> impl Strategy<Value = JointLaw> {
        let curve = (1e4..1e6f64, 1e4..1e6f64, 1e4..1e6f64, 1.0..50.0f64, 50.0..200.0f64);
        let curve = curve.prop_map(|(k1, k2, k3, t1_nm, t2_nm)| Windup {
            k1_nm_per_rad: k1,
            k2_nm_per_rad: k2,
            k3_nm_per_rad: k3,
            t1_nm,
            t2_nm,
        });
        let lost = prop::option::of((1e-5..1e-3f64, 1.0..50.0f64));
        (curve, 0.0..1e-5f64, lost, prop::option::of(1e-5..1e-3f64), any::<bool>()).prop_map(
            |(curve, connection, lost, play, by_k1)| JointLaw {
                curve: if by_k1 { Curve::WindupK1(curve) } else { Curve::Windup(curve) },
                connection_rad_per_nm: connection,
                lost_motion: lost.map(|(half_width_rad, torque_nm)| LostMotion { half_width_rad, torque_nm }),
                hysteresis_rad: play.unwrap_or(0.0),
                waves: [0.0; 4],
                further: None,
            },
        )
    }

    proptest! {
        #[test]
        fn no_slope_between_two_torques_leaves_the_range(
            law in law(),
            ends in (-300.0..300.0f64, -300.0..300.0f64),
            inside in (0.0..1.0f64, 0.0..1.0f64),
        ) {
            let (low, high) = (ends.0.min(ends.1), ends.0.max(ends.1));
            let [a, b] = [inside.0, inside.1].map(|part| low + part * (high - low));
            let [least, most] = tangent_range(&law, [low, high]);
            let tangent = law.tangent_compliance_rad_per_nm(a);
            prop_assert!(least <= tangent * (1.0 + 1e-12) && tangent <= most * (1.0 + 1e-12));
            prop_assume!((b - a).abs() > 1e-3);
            let [least, most] = rising_range(&law, [low, high]);
            let slope = (law.rising_angle_rad(b) - law.rising_angle_rad(a)) / (b - a);
            let rounding = 1e-12 * (most.abs() + slope.abs()) + 1e-15;
            prop_assert!(least <= slope + rounding, "{least} {slope}");
            prop_assert!(slope <= most + rounding, "{slope} {most}");
        }
    }
}
