//! How the mass of a design adds up along its chain.

use super::problem::{ArmProblem, Partial};
use super::slot::Slot;

impl ArmProblem<'_> {
    /// Mass of each piece of a complete arm together with everything outboard of it \[kg\], base to tip. A piece has
    /// its drive, bearing, bodies and stages, and the motors of other joints that stand on it. A motor that does not
    /// stand at its joint counts where it stands. The payload does not count.
    pub(crate) fn masses_inward_kg(&self, complete: &Partial) -> Vec<f64> {
        let mut out = vec![0.0; self.space().pieces.len()];
        let mut total_kg = 0.0;
        let options = complete.slot_options();
        for (slot, (piece, _)) in self.space().layers().into_iter().enumerate() {
            total_kg += match &self.slots()[slot] {
                Slot::Link { options: links, .. } => links[options[slot] as usize].mass_kg,
                Slot::Offset { mass_kg } => *mass_kg,
                _ => complete.masses_kg[slot],
            };
            out[piece] = total_kg;
        }
        out
    }
}
