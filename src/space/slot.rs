//! The pieces of an arm as the search builds it: what is given, what is sized, what is chosen.

use super::design_space::{DesignSpace, DriveChoice, LinkChoice, LinkOption, SpaceJoint};
use super::figures::{OptionFigures, figures};
use crate::arm::file::windup_of;
use crate::arm::joint_law::{Curve, JointLaw};
use crate::arm::{Link, LinkBody};
use crate::catalog::Catalogs;
use crate::sizing::demand::{JointDemand, JointMotion};
use crate::sizing::select::{DriveFilter, DriveTable};

/// What the search adds in one step, tip first.
pub(crate) enum Slot<'c> {
    Given { law: JointLaw, mass_kg: f64 },
    Sized(SizedJoint<'c>),
    Link { options: Vec<OptionFigures>, open: bool },
    Offset { mass_kg: f64 },
}

/// A joint whose drive the catalogs give.
pub struct SizedJoint<'c> {
    /// Every legal drive, lightest first.
    pub table: DriveTable<'c>,
    pub(crate) laws: Vec<JointLaw>,
    pub(crate) all_fits: bool,
}

impl SizedJoint<'_> {
    /// Whether its drive is a choice of the search.
    pub fn is_level(&self) -> bool {
        self.all_fits
    }

    /// Its drives by kinds: those of a kind weigh and twist alike, so that no objective tells them apart, but each holds
    /// torques of its own. Kinds in the order of their first drives, drives ascending.
    pub(crate) fn kinds(&self) -> Vec<Vec<u32>> {
        let mut kinds: Vec<Vec<u32>> = Vec::new();
        // equal masses stand side by side: only the kinds of the last mass may have one more
        let mut first_of_mass = 0;
        for index in 0..self.table.len() {
            let of_kind = |kind: &&mut Vec<u32>| self.are_alike(kind[0] as usize, index);
            if index > 0 && self.table.mass_kg(index) != self.table.mass_kg(index - 1) {
                first_of_mass = kinds.len();
            }
            match kinds[first_of_mass..].iter_mut().find(of_kind) {
                Some(kind) => kind.push(index as u32),
                None => kinds.push(vec![index as u32]),
            }
        }
        kinds
    }

    /// The drives of a drive's kind that hold a demand.
    pub(crate) fn alike<'t>(
        &'t self,
        index: usize,
        demand: &'t JointDemand,
    ) -> impl Iterator<Item = usize> + 't {
        self.table.all_fits(demand).filter(move |other| self.are_alike(*other, index))
    }

    /// Whether two drives weigh and twist alike.
    pub(crate) fn are_alike(&self, a: usize, b: usize) -> bool {
        self.table.mass_kg(a) == self.table.mass_kg(b) && self.laws[a] == self.laws[b]
    }
}

impl Slot<'_> {
    pub fn is_level(&self) -> bool {
        matches!(self, Slot::Link { open: true, .. } | Slot::Sized(SizedJoint { all_fits: true, .. }))
    }

    pub fn options(&self) -> u32 {
        match self {
            Slot::Link { options, .. } => options.len() as u32,
            Slot::Sized(sized) => sized.table.len() as u32,
            _ => 1,
        }
    }

    /// Mass of a piece that is not chosen \[kg\].
    pub fn fixed_kg(&self) -> Option<f64> {
        match self {
            Slot::Given { mass_kg, .. } | Slot::Offset { mass_kg } => Some(*mass_kg),
            _ => None,
        }
    }

    /// How the joint twists with one of its drives.
    pub fn law(&self, option: usize) -> Option<&JointLaw> {
        match self {
            Slot::Given { law, .. } => Some(law),
            Slot::Sized(sized) => Some(&sized.laws[option]),
            _ => None,
        }
    }

    pub fn motion(&self) -> Option<&JointMotion> {
        match self {
            Slot::Sized(sized) => Some(sized.table.motion()),
            _ => None,
        }
    }
}

pub(crate) fn joint_slot<'c>(
    space: &DesignSpace,
    joint: &SpaceJoint,
    reach_m: f64,
    catalogs: &'c Catalogs,
) -> Slot<'c> {
    let (filter, all_fits) = match &joint.drive {
        DriveChoice::Given { curve, mass_kg, .. } => {
            return Slot::Given { law: space.joint_piece(joint, *curve).law, mass_kg: *mass_kg };
        }
        DriveChoice::FirstFit(filter) => (filter, false),
        DriveChoice::AllFits(filter) => (filter, true),
    };
    let motion = space.motion.joint_motion(reach_m, joint.max_speed_rad_s);
    let table = DriveTable::build(
        &joint.name,
        motion,
        &with_curve(filter, catalogs),
        &catalogs.gears,
        &catalogs.motors,
    );
    let laws = (0..table.len())
        .map(|i| windup_of(table.drive(i).gear).map_or(Curve::Rigid, Curve::Windup))
        .map(|curve| space.joint_piece(joint, curve).law)
        .collect();
    Slot::Sized(SizedJoint { table, laws, all_fits })
}

/// Leaves out gears without a complete torsion curve: what they would deflect cannot be said.
fn with_curve(filter: &DriveFilter, catalogs: &Catalogs) -> DriveFilter {
    let known = catalogs.gears.iter().filter(|g| filter.allows_gear(g) && windup_of(g).is_some());
    DriveFilter { gear_ids: Some(known.map(|g| g.id.clone()).collect()), ..filter.clone() }
}

pub(crate) fn link_slot<'c>(space: &DesignSpace, link: &Link) -> Slot<'c> {
    match &link.body {
        LinkBody::Offset { mass_kg } => Slot::Offset { mass_kg: *mass_kg },
        LinkBody::Tube { material, section, .. } => {
            let option = LinkOption::given(*material, *section);
            let mut figures = figures(space, &option, link.vector_m.norm());
            figures.material = None;
            Slot::Link { options: vec![figures], open: false }
        }
    }
}

pub(crate) fn choice_slot<'c>(space: &DesignSpace, choice: &LinkChoice) -> Slot<'c> {
    let length_m = choice.vector_m.norm();
    Slot::Link { options: choice.options.iter().map(|o| figures(space, o, length_m)).collect(), open: true }
}

impl DesignSpace {
    /// A torsion curve under the study's joint model.
    pub fn curve(&self, curve: Curve) -> Curve {
        curve.reduced(self.joints)
    }
}

impl LinkChoice {
    /// The link with one of its options.
    pub fn link(&self, option: &LinkOption) -> Link {
        Link {
            name: self.name.clone(),
            vector_m: self.vector_m,
            body: LinkBody::Tube {
                material_name: option.material_name.clone(),
                material: option.material,
                section: option.section,
            },
        }
    }

    /// The link with its first option; a rigid offset if there is none.
    pub(crate) fn first_link(&self) -> Link {
        let nothing = || Link {
            name: self.name.clone(),
            vector_m: self.vector_m,
            body: LinkBody::Offset { mass_kg: 0.0 },
        };
        self.options.first().map_or_else(nothing, |option| self.link(option))
    }
}
