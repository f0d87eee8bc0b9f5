//! The number of readings of a made campaign, and how large their noise and gross errors are.

use super::Dice;

/// How large and how clean a campaign is.
#[derive(Clone, Copy)]
pub struct Plan {
    /// Static poses of five loads.
    pub static_poses: usize,
    /// Modal poses, each with and without payload.
    pub modal_poses: usize,
    /// Whether there is a bench test.
    pub bench: bool,
    /// True over declared standard deviation.
    pub noise: f64,
    /// Part of static readings that are gross errors.
    pub gross: f64,
    /// Factor on the typical size of an effect.
    pub size: f64,
    /// Poses whose absolute position is measured.
    pub positions: usize,
    /// Standard deviation of each component of each link's vector \[m\].
    pub lengths_m: f64,
}

impl Plan {
    /// Much clean data.
    pub fn plain() -> Self {
        Self {
            static_poses: 40,
            modal_poses: 12,
            bench: true,
            noise: 1.0,
            gross: 0.0,
            size: 1.0,
            positions: 0,
            lengths_m: 0.0,
        }
    }

    /// Little data, small effects, gross errors, too small declared deviations.
    pub fn hard(dice: &mut Dice) -> Self {
        let modal_poses = if dice.uniform() < 0.7 { 6 } else { 0 };
        let bench = dice.uniform() < 0.6;
        Self {
            static_poses: 14,
            modal_poses,
            bench,
            noise: 1.15,
            gross: 1.0 / 60.0,
            size: 0.35,
            ..Self::plain()
        }
    }

    /// Much clean data of one kind of readings.
    pub(super) fn of_channel(channel: &str) -> Self {
        let (static_poses, modal_poses) = match channel {
            "static" => (24, 0),
            "modal" => (0, 16),
            _ => (0, 0),
        };
        Self { static_poses, modal_poses, bench: channel == "windup", ..Self::plain() }
    }

    /// Draws the number of poses, the noise, the share of gross errors and the sizes of effects at random.
    pub fn varied(dice: &mut Dice) -> Self {
        Self {
            static_poses: 8 + (dice.uniform() * 30.0) as usize,
            modal_poses: (dice.uniform() * 12.0) as usize,
            bench: dice.uniform() < 0.6,
            noise: *dice.pick(&[1.0, 1.0, 1.15]),
            gross: *dice.pick(&[0.0, 0.0, 1.0 / 60.0]),
            size: dice.between(0.35, 1.2),
            ..Self::plain()
        }
    }
}
