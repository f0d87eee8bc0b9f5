//! Evaluation of one design by the full model, with all checks and limits.
//!
//! The arm of a design is built from the question's own numbers and the catalog rows of its drives. Statics and modes
//! are computed by `mechanics`, the full model that `armwright analyze` uses. The demands on drives and tubes are
//! computed by this folder, with each weight known exactly.

use super::bound::Members;
use super::carriers::carriers;
use super::drive_range::DriveRange;
use super::offers::{CatalogOffers, JointOffers, Offer};
use super::question::{AskedDrive, AskedJoint, AskedLink, AskedPiece, Question};
use super::skeleton::{Skeleton, joint_offers};
use super::tubes::{TubeNumbers, TubeOptions, TubeRange, is_too_slender};
use crate::arm::joint_law::Curve;
use crate::arm::load::Water;
use crate::arm::{Arm, Element};
use crate::catalog::Catalogs;
use crate::mechanics::chain::Chain;
use crate::pareto::objectives::Objectives;
use std::sync::Arc;

/// The part that a design has at one piece of the chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Pick {
    /// The part that the question gives, or the drive that the first-fit rule determines: the lightest drive that meets
    /// the demand.
    Given,
    /// A drive of the catalogs, given by the indices of its gear and motor.
    Drive {
        /// Index of the gear in the catalogs.
        gear: usize,
        /// Index of the motor in the catalogs.
        motor: usize,
    },
    /// A tube, given by its index in the link's list of tubes.
    Tube(usize),
}

/// A design that meets every check and every limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// The part at each piece, base to tip. A drive that the first-fit rule determined is given by its gear and motor
    /// too.
    pub picks: Vec<Pick>,
    /// The objectives of the design by the full model.
    pub objectives: Objectives,
}

/// Judges the designs of a question by the full model.
pub struct Judge<'q> {
    pub(super) question: &'q Question,
    pub(super) skeleton: Arc<Skeleton>,
    pub(super) offers: Vec<JointOffers>,
}

/// The drive that was determined for a joint of a design, and its numbers as the bounds need them.
struct Fitted {
    range: DriveRange,
    pick: Pick,
}

impl<'q> Judge<'q> {
    /// Reads the drives that the catalogs offer, and puts the arm into every case of the question.
    pub fn new(question: &'q Question, catalogs: &Catalogs) -> Self {
        let offers = joint_offers(question, catalogs);
        Self { question, skeleton: Arc::new(Skeleton::new(question, &offers)), offers }
    }

    /// The question whose designs are judged.
    pub fn question(&self) -> &Question {
        self.question
    }

    /// Judges a design. `None` if it fails a check or a limit, or if it is not a design of the question. The result is
    /// also `None` if a joint with the first-fit rule has another drive in `picks` than the lightest drive that passes.
    ///
    /// A torque that exceeds a rating by less than 1e-9 (relative) still passes, and so does a stress that close to
    /// its limit.
    pub fn judge(&self, picks: &[Pick]) -> Option<Judged> {
        let tubes = self.tubes(picks)?;
        let picks = self.with_drives(picks, &tubes)?;
        let arm = self.arm(&picks)?;
        let objectives = self.objectives(&arm);
        let limits = &self.question.limits;
        let within = |value: f64, most: Option<f64>| most.is_none_or(|most| value <= most);
        let holds = within(objectives.tip_deflection_m, limits.tip_deflection_max_m)
            && within(objectives.mass_kg, limits.mass_max_kg)
            && objectives.lowest_mode_hz >= limits.required_mode_hz()
            && within(self.material_cost_eur(&picks), limits.material_cost_max_eur);
        holds.then_some(Judged { picks, objectives })
    }

    /// The design with every drive replaced by the first drive in the list with equal mass, torsion curve and bearing
    /// stiffness. If the result is the same for two designs, they differ only in drives that tie.
    pub fn first_tie(&self, picks: &[Pick]) -> Vec<Pick> {
        let mut joints = self.offers.iter();
        let first = |(piece, pick): (&AskedPiece, &Pick)| {
            let offers = match piece {
                AskedPiece::Joint(_) => joints.next().and_then(JointOffers::of_catalog),
                _ => None,
            };
            let first = offers.and_then(|offers| Some(offers.first_tie(offer_of(offers, pick)?)));
            first.map_or(*pick, |offer| Pick::Drive { gear: offer.gear, motor: offer.motor })
        };
        self.question.pieces.iter().zip(picks).map(first).collect()
    }

    /// The tubes of a design, base to tip, each as a range of a single tube. `picks` are the parts of the design.
    /// `None` if a tube is too slender.
    fn tubes(&self, picks: &[Pick]) -> Option<Vec<TubeRange>> {
        let (question, waters): (_, &[Option<Water>]) = (self.question, &self.skeleton.waters);
        let mut tubes = Vec::new();
        for ((carrier, piece), pick) in carriers(question).zip(picks) {
            match piece {
                AskedPiece::Joint(_) | AskedPiece::Prismatic(_) => {}
                AskedPiece::Link(link) => {
                    if let Some(options) = TubeOptions::of_link(question, carrier, link, waters) {
                        tubes.push(TubeRange::one(&options.tubes.first()?.1));
                    }
                }
                AskedPiece::Choice(choice) => {
                    let tube = tube_of(choice, pick)?;
                    if is_too_slender(question, &tube.section) {
                        return None;
                    }
                    let numbers = TubeNumbers::of_choice(question, carrier, choice, tube, waters);
                    tubes.push(TubeRange::one(&numbers));
                }
            }
        }
        Some(tubes)
    }

    /// Checks from the tip inward whether every drive meets the demand of everything outboard of it. Returns the parts
    /// of the design: the parts in `picks`, and for each joint with the first-fit rule the lightest drive that passes.
    /// `None` if a drive or a tube fails.
    fn with_drives(&self, picks: &[Pick], tubes: &[TubeRange]) -> Option<Vec<Pick>> {
        let pieces = self.question.pieces.iter().enumerate();
        let places: Vec<usize> = pieces
            .filter(|(_, piece)| matches!(piece, AskedPiece::Joint(_)))
            .map(|(place, _)| place)
            .collect();
        let nothing = DriveRange::of(&Curve::Rigid.into(), 0.0, 0.0);
        let mut members =
            Members::new(vec![nothing; places.len()], tubes.iter().collect(), self.skeleton.waters.len());
        let mut out = picks.to_vec();
        for joint in (0..places.len()).rev() {
            let fitted = self.fitted(joint, &picks[places[joint]], &members)?;
            members.set_drive(joint, fitted.range);
            out[places[joint]] = fitted.pick;
        }
        self.skeleton.strong_enough(&members).then_some(out)
    }

    /// The drive of a joint, as `pick` names it or as the first-fit rule determines it. `None` if it fails a check. The
    /// drives outboard of the joint must be set in `members`.
    fn fitted(&self, joint: usize, pick: &Pick, members: &Members) -> Option<Fitted> {
        let offers = match &self.offers[joint] {
            JointOffers::Given { law, tilt_rad_per_nm, mass_kg } => {
                let range = DriveRange::of(law, *tilt_rad_per_nm, *mass_kg);
                return Some(Fitted { range, pick: Pick::Given });
            }
            JointOffers::Catalog(offers) => offers,
        };
        let [least, most] = self.skeleton.demands(joint, &offers.duty, members);
        let named = offer_of(offers, pick);
        let offer = match (offers.is_choice, *pick) {
            (true, _) | (false, Pick::Drive { .. }) => named.filter(|offer| offer.ratings.hold(&least))?,
            (false, _) => offers.first_fit(&least)?,
        };
        if !offers.is_choice {
            // No drive before it in the list may carry even the greatest demand. Such a drive would be the first fit.
            let before = offers.offers.iter().take_while(|other| *other != offer);
            before.into_iter().all(|other| !other.ratings.hold(&most)).then_some(())?;
        }
        let pick = Pick::Drive { gear: offer.gear, motor: offer.motor };
        Some(Fitted { range: offer.range(), pick })
    }

    /// The arm of a design with all of its parts. `None` if a part in `picks` is not one of the options of its piece.
    fn arm(&self, picks: &[Pick]) -> Option<Arm> {
        let mut joints = self.offers.iter();
        let element = |(piece, pick): (&AskedPiece, &Pick)| match piece {
            AskedPiece::Joint(joint) => self.joint(joint, joints.next()?, pick),
            AskedPiece::Prismatic(rail) => Some(Element::Prismatic(rail.joint.clone())),
            AskedPiece::Link(link) => Some(Element::Link(link.clone())),
            AskedPiece::Choice(choice) => Some(Element::Link(choice.with_tube(tube_of(choice, pick)?))),
        };
        let chain = self.question.pieces.iter().zip(picks).map(element).collect::<Option<Vec<_>>>()?;
        Some(self.question.arm(chain))
    }

    fn joint(&self, joint: &AskedJoint, offers: &JointOffers, pick: &Pick) -> Option<Element> {
        if let AskedDrive::Given { curve, mass_kg } = joint.drive {
            return Some(joint.with_drive(curve, mass_kg, joint.bearing.stated(), joint.extras.stated()));
        }
        let offer = offer_of(offers.of_catalog()?, pick)?;
        let curve = Curve::Windup(offer.windup);
        Some(joint.with_drive(curve, offer.drive_kg, offer.bearing, offer.extras))
    }

    fn objectives(&self, arm: &Arm) -> Objectives {
        let mut worst =
            Objectives { tip_deflection_m: 0.0, mass_kg: arm.mass_kg(), lowest_mode_hz: f64::INFINITY };
        for case in self.question.judged_cases.iter().map(|&case| &self.question.cases[case]) {
            let chain = Chain::new(&arm.structure_in(case), case.links);
            let posed = chain.pose(case);
            let statics = posed.statics();
            worst.tip_deflection_m = worst.tip_deflection_m.max(statics.tip_displacement_m.norm());
            worst.lowest_mode_hz = worst.lowest_mode_hz.min(posed.lowest_frequency_hz(&statics));
        }
        worst
    }

    /// Cost of the chosen tubes \[EUR\]. Material of unknown cost counts as zero.
    fn material_cost_eur(&self, picks: &[Pick]) -> f64 {
        let costs = self.question.pieces.iter().zip(picks).rev().filter_map(|(piece, pick)| match piece {
            AskedPiece::Choice(choice) => {
                let tube = tube_of(choice, pick)?;
                let area_m2 = tube.section.properties(tube.material.poisson).area_m2;
                let mass_kg = tube.material.density_kg_m3 * area_m2 * choice.vector_m.norm();
                Some(tube.cost_eur_per_kg? * mass_kg)
            }
            _ => None,
        });
        costs.sum()
    }
}

fn offer_of<'o>(offers: &'o CatalogOffers, pick: &Pick) -> Option<&'o Offer> {
    match *pick {
        Pick::Drive { gear, motor } => offers.of(gear, motor),
        _ => None,
    }
}

fn tube_of<'l>(choice: &'l AskedLink, pick: &Pick) -> Option<&'l super::question::AskedTube> {
    match *pick {
        Pick::Tube(place) => choice.tubes.get(place),
        _ => None,
    }
}
