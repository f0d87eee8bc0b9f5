//! Compiles a design space into the [`Problem`] of branch and bound.

use super::compile_pose::harness_kg;
use super::joint_play::JointPlay;
use super::kinds::{Kinds, Ties};
use super::lowest_eigenvalue::CaseInertia;
use super::parts::{DriveBox, LinkBox, Rays};
use super::pose::Pose;
use super::problem::{Ladder, Part, Problem};
use super::shape::Ideal;
use super::torsion::{BreakPoints, CurveBox};
use super::tree::Tree;
use super::work::Work;
use crate::arm::LinkBody;
use crate::arm::joint_law::Curve;
use crate::catalog::Catalogs;
use crate::sizing::demand::JointMotion;
use crate::space::design_space::{DesignSpace, LinkOption, SpacePiece};
use crate::space::effects::Layer;
use crate::space::slot::{SizedJoint, Slot, joint_slot};
use crate::space::station::reaches_m;
use std::sync::Arc;

impl<'c> Problem<'c> {
    /// Compiles a space with the link options for which `takes` is true. `ties` says whether drives of equal mass and
    /// equal curve are one option. `None` if some level has no option.
    pub(super) fn new(
        space: &'c DesignSpace,
        catalogs: &'c Catalogs,
        takes: &dyn Fn(&LinkOption) -> bool,
        ties: Ties,
    ) -> Option<Self> {
        let sizing = space.sizing_cases.iter().map(|&i| &space.cases[i]);
        let mut reaches = reaches_m(space, sizing).into_iter();
        let of = |piece: &SpacePiece| match piece {
            SpacePiece::Joint(_) => reaches.next().unwrap_or_default(),
            _ => 0.0,
        };
        let reaches_m: Vec<f64> = space.pieces.iter().map(of).collect();
        let mut problem = Self {
            space,
            parts: Vec::new(),
            level_pieces: Vec::new(),
            level_sizes: Vec::new(),
            poses: Arc::new((0..space.cases.len()).map(|i| Pose::new(space, i)).collect()),
            inertias: Arc::default(),
            peak_factor: 1.0
                + space.motion.tip_acceleration_m_s2() / space.gravity_m_s2.max(f64::MIN_POSITIVE),
            lighter_is_better: false,
            joint_plays: Vec::new(),
            force_bounds: Arc::default(),
        };
        for (place, layer) in space.layers() {
            let part = match layer {
                Layer::Piece(piece) => problem.part(piece, reaches_m[place], catalogs, takes, ties)?,
                Layer::Tilt(tilt) => Part::Given { mass_kg: 0.0, curve: CurveBox::of(&tilt.law()) },
                // A given mass beyond the parts loads the arm, but a design's mass does not count it.
                Layer::Mass(_) => Part::Offset { mass_kg: 0.0 },
                Layer::Extra(mass_kg) => Part::Offset { mass_kg },
                Layer::Bearing(_) => Part::Offset { mass_kg: 0.0 },
            };
            problem.parts.push(part);
            // Play belongs to the joint, whichever drive it has.
            problem.joint_plays.push(match layer {
                Layer::Piece(SpacePiece::Joint(joint)) => {
                    JointPlay::of(&space.joint_piece(joint, Curve::Linear(1.0), None).law)
                }
                _ => None,
            });
            // A harness moves and weighs with its link, so the link's inertia has it. The mass of a design
            // does not count it; a negative offset takes it out of the sum of masses.
            if let Layer::Piece(piece) = layer
                && let Some(harness_kg) = harness_kg(space, piece)
            {
                problem.parts.push(Part::Offset { mass_kg: -harness_kg });
                problem.joint_plays.push(None);
            }
        }
        problem.lighter_is_better = problem.grows_with_weight();
        Some(problem.with_inertias())
    }

    /// Compiles one piece of the chain. `None` if it has no option.
    fn part(
        &mut self,
        piece: &'c SpacePiece,
        reach_m: f64,
        catalogs: &'c Catalogs,
        takes: &dyn Fn(&LinkOption) -> bool,
        ties: Ties,
    ) -> Option<Part<'c>> {
        let space = self.space;
        Some(match piece {
            SpacePiece::Joint(joint) => match joint_slot(space, joint, reach_m, catalogs) {
                Slot::Given { law, mass_kg } => Part::Given { mass_kg, curve: CurveBox::of(&law) },
                Slot::Sized(sized) if sized.all_fits => self.drives(sized, ties)?,
                Slot::Sized(sized) => self.first_fit(sized)?,
                Slot::Link { .. } | Slot::Offset { .. } | Slot::Bearing { .. } => return None,
            },
            SpacePiece::Choice(choice) => {
                let slender = |option: &LinkOption| {
                    space.constraints.wall_slenderness_max.is_some_and(|max| option.wall_slenderness() > max)
                };
                let options = self.level(choice.options.len());
                let boxes = options
                    .map(|i| (i, &choice.options[i as usize]))
                    .filter(|(_, option)| takes(option) && !slender(option))
                    .map(|(i, o)| (i, LinkBox::of(o, &space.link_piece(&choice.link(o)), space.links)));
                Part::Links { length_m: choice.vector_m.norm(), tree: Arc::new(Tree::build(boxes)?) }
            }
            SpacePiece::Link(link) => match &link.body {
                LinkBody::Offset { mass_kg } => Part::Offset { mass_kg: *mass_kg },
                LinkBody::Tube { material, section, .. } => {
                    let option = LinkOption::given(*material, *section);
                    let slender = space.constraints.wall_slenderness_max;
                    if slender.is_some_and(|max| option.wall_slenderness() > max) {
                        return None;
                    }
                    let tube = Box::new(LinkBox::of(&option, &space.link_piece(link), space.links));
                    Part::Tube { length_m: link.vector_m.norm(), tube }
                }
            },
        })
    }

    /// A joint whose drive is a level of the search.
    fn drives(&mut self, sized: SizedJoint<'c>, ties: Ties) -> Option<Part<'c>> {
        self.level(sized.table.len());
        let rays = self.rays(self.parts.len(), sized.table.motion());
        let kinds = Kinds::of(&sized, ties);
        let drives = |kind: &[u32]| DriveBox::of_kind(kind.iter().map(|&i| drive_box(&sized, i, &rays)));
        let tree = Tree::build(kinds.iter().filter_map(|kind| Some((kind[0], drives(kind)?))))?;
        Some(Part::Drives {
            sized: Arc::new(sized),
            kinds: Arc::new(kinds),
            tree: Arc::new(tree),
            rays: Arc::new(rays),
        })
    }

    /// A joint that takes the lightest drive that can carry its load.
    fn first_fit(&self, sized: SizedJoint<'c>) -> Option<Part<'c>> {
        let rays = self.rays(self.parts.len(), sized.table.motion());
        let candidates = sized.table.first_fit_candidates();
        let steps: Vec<DriveBox> = candidates.iter().map(|&i| drive_box(&sized, i, &rays)).collect();
        let ladder = (!steps.is_empty()).then(|| Arc::new(Ladder::new(steps)))?;
        Some(Part::FirstFit { ladder, sized: Arc::new(sized) })
    }

    /// Opens the next level and returns the numbers of its options.
    fn level(&mut self, size: usize) -> std::ops::Range<u32> {
        self.level_pieces.push(self.parts.len());
        self.level_sizes.push(size as u32);
        0..size as u32
    }

    /// The rays of a joint: fixed proportions of static torque and inertia, around the proportion that the payload
    /// alone causes.
    fn rays(&self, piece: usize, motion: &JointMotion) -> Rays {
        let (mut static_nm, mut inertia_kgm2) = (0.0f64, 0.0f64);
        for pose in self.poses.iter().filter(|pose| pose.sizing) {
            let Some(row) = &pose.inertia_about[piece] else { continue };
            static_nm = static_nm.max(pose.payload_torque_nm(piece).abs());
            inertia_kgm2 = inertia_kgm2.max(row.fixed);
        }
        Rays::new(motion, static_nm, inertia_kgm2)
    }

    /// Adds the inertia matrices of every judged case. An arbitrary arm of the space shows which coordinates yield.
    pub(super) fn with_inertias(mut self) -> Self {
        let mut work = Work::default();
        let filled = self.fill(&mut self.root(), &mut work);
        if filled.and_then(|()| self.least_tip_m(&mut work)).is_some() {
            let of = |case: usize| {
                let ideal = Ideal { stiffness: &work.stiff_in[case], inertia: &work.light };
                CaseInertia::new(&self.poses[case], &ideal)
            };
            self.inertias = Arc::new(self.judged_cases().map(of).collect());
        }
        self
    }
}

/// The box of a single drive.
fn drive_box(sized: &SizedJoint, index: u32, rays: &Rays) -> DriveBox {
    let index = index as usize;
    let mass_kg = sized.table.mass_kg(index);
    let curve = CurveBox::of(&sized.laws[index]);
    DriveBox {
        mass_kg: [mass_kg; 2],
        limits: *sized.table.limits(index),
        least_limits: *sized.table.limits(index),
        multiples: rays.capacity(sized.table.limits(index)),
        curve,
        breaks: curve.map_or_else(BreakPoints::default, |c| BreakPoints::of(&c.stiff.windup)),
        each: None,
    }
}
