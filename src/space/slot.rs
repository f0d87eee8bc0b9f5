//! Slots: the elements of an arm in the order in which the search adds them, tip first.

use super::attributes::{OptionAttributes, attributes_of};
use super::design_space::{DesignSpace, DriveChoice, LinkChoice, LinkOption, SpaceJoint};
use super::prismatic::SpacePrismatic;
use crate::arm::bearing::BearingSource;
use crate::arm::joint_law::{Curve, JointLaw};
use crate::arm::structure::JointPiece;
use crate::arm::{Link, LinkBody};
use crate::catalog::Catalogs;
use crate::sizing::demand::{JointDemand, JointMotion};
use crate::sizing::select::{DriveFilter, DriveTable};
use std::sync::Arc;

/// One slot: the piece of an arm that the search adds in one step.
pub(crate) enum Slot<'c> {
    /// A joint whose drive the study gives, or a spring that an effect adds.
    Given { law: JointLaw, mass_kg: f64 },
    /// A joint whose drive comes from the catalogs.
    Sized(Arc<SizedJoint<'c>>),
    /// A spring of the bearing of a sized joint: the slot of the joint, and the joint law of the spring with each
    /// drive.
    Bearing { joint: usize, laws: Vec<JointLaw> },
    /// The motor of a sized joint, if it does not stand at the joint: the slot of the joint, and the mass of the motor
    /// with each drive \[kg\].
    Motor { joint: usize, masses_kg: Vec<f64> },
    /// A tube. It is a choice of the search if it is `open`; a given tube has one option.
    Link { options: Vec<OptionAttributes>, open: bool },
    /// A rigid offset with its point mass. Bodies, masses of effects and spring forces have slots of this kind too.
    Offset { mass_kg: f64 },
}

/// A joint whose drive is sized from the catalogs.
pub struct SizedJoint<'c> {
    /// Every drive that the study allows for this joint, lightest first.
    pub table: DriveTable<'c>,
    /// Joint law (angle as a function of torque) with each drive of the table. Effects are included.
    pub(crate) laws: Vec<JointLaw>,
    /// Compliance of the output bearing against tilt \[rad/(N m)\], one entry for each drive. It is the compliance of
    /// the gear's bearing plus the compliance that effects add.
    pub(crate) tilts_rad_per_nm: Vec<f64>,
    /// For each drive of the table, the part of its mass that does not sit at the joint \[kg\]. An example is the mass
    /// of a motor that is placed elsewhere. It is 0 if the whole drive sits at the joint.
    pub(crate) away_kg: Vec<f64>,
    /// Whether the search may choose every drive that meets the demand. If not, the joint gets the lightest drive that
    /// meets it.
    pub(crate) all_fits: bool,
}

impl SizedJoint<'_> {
    /// Whether the search chooses the drive of the joint.
    pub fn is_level(&self) -> bool {
        self.all_fits
    }

    /// Least mass that a drive has at the joint, without a motor that stands elsewhere \[kg\]; 0 if there is no drive.
    pub(crate) fn least_kg_at_joint(&self) -> f64 {
        let at_joint = self.away_kg.iter().enumerate().map(|(drive, away)| self.table.mass_kg(drive) - away);
        at_joint.reduce(f64::min).unwrap_or(0.0)
    }

    /// The drives of the joint, sorted into kinds. The drives of a kind have equal mass, an equal torsion curve and an
    /// equal bearing compliance, so no objective differs between them. Each drive has torque limits of its own. Kinds
    /// are in the order of their first drives. The drives of a kind are in ascending order.
    pub(crate) fn kinds(&self) -> Vec<Vec<u32>> {
        let mut kinds: Vec<Vec<u32>> = Vec::new();
        // Drives are sorted by mass, so a drive can belong only to a kind of the same mass.
        let mut first_of_mass = 0;
        for index in 0..self.table.len() {
            let of_kind = |kind: &&mut Vec<u32>| self.are_ties(kind[0] as usize, index);
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

    /// The drives that meet `demand` and are ties of the drive `index`: equal to it in mass, torsion curve and bearing
    /// compliance. The drive itself is among them if it meets the demand.
    pub(crate) fn ties_of<'t>(
        &'t self,
        index: usize,
        demand: &'t JointDemand,
    ) -> impl Iterator<Item = usize> + 't {
        self.table.all_fits(demand).filter(move |other| self.are_ties(*other, index))
    }

    /// Whether two drives are ties: equal in mass (at the joint and elsewhere), torsion curve and bearing compliance.
    pub(crate) fn are_ties(&self, a: usize, b: usize) -> bool {
        self.table.mass_kg(a) == self.table.mass_kg(b)
            && self.laws[a] == self.laws[b]
            && self.tilts_rad_per_nm[a] == self.tilts_rad_per_nm[b]
            && self.away_kg[a] == self.away_kg[b]
    }
}

impl<'c> Slot<'c> {
    /// The slot of one of the two springs of an output bearing. The bearing belongs to the joint in slot `joint`, which
    /// comes earlier in `slots`.
    pub(crate) fn bearing(joint: usize, slots: &[Slot<'c>]) -> Self {
        let spring = |rad_per_nm: &f64| JointLaw {
            connection_rad_per_nm: *rad_per_nm,
            ..JointLaw::from(Curve::Rigid)
        };
        let laws = match &slots[joint] {
            Slot::Sized(sized) => sized.tilts_rad_per_nm.iter().map(spring).collect(),
            _ => Vec::new(),
        };
        Slot::Bearing { joint, laws }
    }

    /// The slot of a motor that does not stand at its joint. The joint is in slot `joint`, which comes earlier in
    /// `slots`.
    pub(crate) fn motor(joint: usize, slots: &[Slot<'c>]) -> Self {
        let masses_kg = match &slots[joint] {
            Slot::Sized(sized) => sized.away_kg.clone(),
            _ => Vec::new(),
        };
        Slot::Motor { joint, masses_kg }
    }
}

impl Slot<'_> {
    /// Whether the search chooses the option of this slot.
    pub(crate) fn is_level(&self) -> bool {
        match self {
            Slot::Link { open, .. } => *open,
            Slot::Sized(sized) => sized.all_fits,
            _ => false,
        }
    }

    /// Number of options of this slot; 1 if nothing is chosen. For a sized joint it is the number of drives in its
    /// table.
    pub(crate) fn options(&self) -> u32 {
        match self {
            Slot::Link { options, .. } => options.len() as u32,
            Slot::Sized(sized) => sized.table.len() as u32,
            _ => 1,
        }
    }

    /// Mass of the slot \[kg\] if it is the same for all options; `None` for sized joints and for tubes.
    pub(crate) fn fixed_kg(&self) -> Option<f64> {
        match self {
            Slot::Given { mass_kg, .. } | Slot::Offset { mass_kg } => Some(*mass_kg),
            Slot::Bearing { .. } | Slot::Motor { .. } => Some(0.0),
            _ => None,
        }
    }

    /// The tube of the slot if the study gives it; `None` if the slot is not a tube or the search chooses the tube.
    pub(crate) fn given_tube(&self) -> Option<&OptionAttributes> {
        match self {
            Slot::Link { options, open: false } => options.first(),
            _ => None,
        }
    }

    /// The joint law (angle as a function of torque) that the slot has with the drive `option`. `None` if the slot has
    /// no joint or spring.
    pub(crate) fn law(&self, option: usize) -> Option<&JointLaw> {
        match self {
            Slot::Given { law, .. } => Some(law),
            Slot::Sized(sized) => Some(&sized.laws[option]),
            Slot::Bearing { laws, .. } => Some(&laws[option]),
            _ => None,
        }
    }

    /// The motion that a sized joint must be able to make; `None` for other slots.
    pub(crate) fn motion(&self) -> Option<&JointMotion> {
        match self {
            Slot::Sized(sized) => Some(sized.table.motion()),
            _ => None,
        }
    }
}

/// The slot of a joint that turns. The tip is at most `reach_m` \[m\] away from its axis.
pub(crate) fn joint_slot<'c>(
    space: &DesignSpace,
    joint: &SpaceJoint,
    reach_m: f64,
    catalogs: &'c Catalogs,
) -> Slot<'c> {
    let (filter, all_fits) = match &joint.drive {
        DriveChoice::Given { curve, mass_kg, .. } => {
            let law = space.joint_piece(joint, *curve, joint.bearing.stated()).law;
            return Slot::Given { law, mass_kg: *mass_kg + joint.extras.stated().total_kg() };
        }
        DriveChoice::FirstFit(filter) => (filter, false),
        DriveChoice::AllFits(filter) => (filter, true),
    };
    let motion = joint.motion(&space.motion, reach_m);
    let table = DriveTable::build(
        &joint.name,
        motion,
        &DriveFilter {
            bearing: joint.bearing,
            extras: joint.extras,
            stage: joint.stages.before,
            needs_torsion: true,
            ..filter.clone()
        },
        &catalogs.gears,
        &catalogs.motors,
    );
    let pieces: Vec<JointPiece> = (0..table.len())
        .map(|i| {
            let drive = table.drive(i);
            space.joint_piece(joint, joint.curve_with(drive.gear), joint.bearing_with(&drive))
        })
        .collect();
    let laws = pieces.iter().map(|piece| piece.law).collect();
    let tilts_rad_per_nm = pieces.iter().map(|piece| piece.tilt_rad_per_nm).collect();
    let away_kg = (0..table.len()).map(|i| joint.away_kg(&table.drive(i))).collect();
    Slot::Sized(Arc::new(SizedJoint { table, laws, tilts_rad_per_nm, away_kg, all_fits }))
}

/// The slot of a prismatic joint.
pub(crate) fn rail_slot<'c>(
    space: &DesignSpace,
    slide: &'c SpacePrismatic,
    catalogs: &'c Catalogs,
) -> Slot<'c> {
    let Some(drive) = &slide.drive else { return Slot::Given { law: space.slide_law(slide), mass_kg: 0.0 } };
    let filter = DriveFilter {
        bearing: BearingSource::Stated(None),
        needs_torsion: true,
        gear_kinds: None,
        gear_series: None,
        gear_ids: None,
        ratios: None,
        ..drive.motors.clone()
    };
    let motion = slide.motion(&space.motion);
    let table = DriveTable::build(&slide.joint.name, motion, &filter, &drive.gears, &catalogs.motors);
    let law = |i: usize| {
        let joint = slide.driven_by(table.drive(i).gear);
        space.slide_law(&SpacePrismatic { joint, ..slide.clone() })
    };
    let laws = (0..table.len()).map(law).collect();
    let tilts_rad_per_nm = vec![0.0; table.len()];
    // Screw and motor stay where the joint begins, so their whole mass counts as mass away from the joint.
    let away_kg = (0..table.len()).map(|i| table.mass_kg(i)).collect();
    Slot::Sized(Arc::new(SizedJoint { table, laws, tilts_rad_per_nm, away_kg, all_fits: false }))
}

/// The slot of a link that the study gives: a tube with one option, or a rigid offset.
pub(crate) fn link_slot<'c>(space: &DesignSpace, link: &Link) -> Slot<'c> {
    match &link.body {
        LinkBody::Offset { mass_kg } => Slot::Offset { mass_kg: *mass_kg },
        LinkBody::Tube { material, section, .. } => {
            let option = LinkOption::given(*material, *section);
            let mut attributes = attributes_of(space, &option, link.vector_m.norm());
            attributes.material = None;
            // The search checks the stress of the links that it chooses. Results say the stress of a given tube.
            attributes.stress = None;
            Slot::Link { options: vec![attributes], open: false }
        }
    }
}

/// The slot of a link whose material and section the search chooses.
pub(crate) fn choice_slot<'c>(space: &DesignSpace, choice: &LinkChoice) -> Slot<'c> {
    let length_m = choice.vector_m.norm();
    Slot::Link {
        options: choice.options.iter().map(|o| attributes_of(space, o, length_m)).collect(),
        open: true,
    }
}

impl DesignSpace {
    /// The torsion curve `curve` as the joint model of the study uses it: with the middle slope K2 alone, or with all
    /// three segments.
    pub fn curve(&self, curve: Curve) -> Curve {
        curve.reduced(self.joints)
    }
}

impl LinkChoice {
    /// The link with `option` as its material and section, in the form of a link that the study gives.
    pub fn link(&self, option: &LinkOption) -> Link {
        Link {
            name: self.name.clone(),
            vector_m: self.vector_m,
            body: LinkBody::Tube {
                material_name: option.material_name.clone(),
                material: option.material,
                section: option.section,
            },
            bodies: self.bodies.clone(),
        }
    }

    /// The link with its first option; a rigid offset without mass if there is no option.
    pub(crate) fn first_link(&self) -> Link {
        let nothing = || Link {
            name: self.name.clone(),
            vector_m: self.vector_m,
            body: LinkBody::Offset { mass_kg: 0.0 },
            bodies: self.bodies.clone(),
        };
        self.options.first().map_or_else(nothing, |option| self.link(option))
    }
}
