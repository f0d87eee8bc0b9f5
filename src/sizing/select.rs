//! Selection of a drive for one joint. A drive table has every admissible pair of gear and motor, sorted by mass.
//!
//! A pair is admissible (*legal*) if the study allows both parts, every rating that a check needs is known, and no
//! speed limit is exceeded. Whether it then meets a demand depends on torques, bearing loads and widths only.

use super::demand::{JointDemand, JointMotion};
use super::drive::Drive;
use super::limits::DriveLimits;
use crate::arm::bearing::{Bearing, BearingSource};
use crate::arm::extras::ExtrasSource;
use crate::arm::transmission::Stage;
use crate::catalog::gear::{Gear, GearKind, GearMass};
use crate::catalog::motor::{Motor, MotorKind};
use std::ops::Range;

/// Which parts of the catalogs a joint may use. A list that is `None` allows all parts.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveFilter {
    /// Which mass of a gear counts: component set or housed unit.
    pub gear_mass: GearMass,
    /// Where the output bearing of the joint comes from.
    pub bearing: BearingSource,
    /// Where the masses of a joint other than gear, motor and bearing come from: stated, or estimated from the parts.
    pub extras: ExtrasSource,
    /// Stage between motor and gear.
    pub stage: Stage,
    /// Whether a gear must have a torsion curve, because the arm's deflection is computed.
    pub needs_torsion: bool,
    /// Allowed series of gears, such as `CSG`; `None` allows all.
    pub gear_series: Option<Vec<String>>,
    /// Allowed reduction ratios; `None` allows all.
    pub ratios: Option<Vec<f64>>,
    /// Allowed kinds of gears; `None` allows all. For actuators [`Self::actuator_ids`] decides instead.
    pub gear_kinds: Option<Vec<GearKind>>,
    /// Names of the allowed gears; `None` allows all.
    pub gear_ids: Option<Vec<String>>,
    /// Models of the allowed actuators; `None` allows all.
    pub actuator_ids: Option<Vec<String>>,
    /// Allowed kinds of motors; `None` allows all. An actuator brings its own motor, which this list does not exclude.
    pub motor_kinds: Option<Vec<MotorKind>>,
    /// Names of the allowed motors; `None` allows all.
    pub motor_ids: Option<Vec<String>>,
}

impl DriveFilter {
    /// A filter that allows all parts of the catalogs. `gear_mass` says which mass of a gear counts.
    pub fn everything(gear_mass: GearMass) -> Self {
        Self {
            gear_mass,
            bearing: BearingSource::OfGear,
            extras: ExtrasSource::NONE,
            stage: Stage::NONE,
            needs_torsion: false,
            gear_series: None,
            ratios: None,
            gear_kinds: None,
            gear_ids: None,
            actuator_ids: None,
            motor_kinds: None,
            motor_ids: None,
        }
    }

    /// This filter, but with the gear and the motor of `drive` as the only parts that it allows.
    pub(crate) fn only(&self, drive: &Drive) -> Self {
        let of_actuator = drive.gear.kind == GearKind::Actuator;
        let one = |id: &str, is_one: bool| Some(if is_one { vec![id.to_string()] } else { Vec::new() });
        Self {
            gear_ids: one(&drive.gear.id, !of_actuator),
            motor_ids: one(&drive.motor.id, !of_actuator),
            actuator_ids: one(&drive.gear.id, of_actuator),
            ..self.clone()
        }
    }

    /// Whether the filter allows this gear for the joint.
    pub fn allows_gear(&self, gear: &Gear) -> bool {
        if gear.kind == GearKind::Actuator {
            return allows(&self.actuator_ids, &gear.id);
        }
        allows(&self.gear_series, &gear.series)
            && allows(&self.ratios, &gear.ratio)
            && allows(&self.gear_kinds, &gear.kind)
            && allows(&self.gear_ids, &gear.id)
    }

    /// Whether the filter allows this motor for the joint.
    pub fn allows_motor(&self, motor: &Motor) -> bool {
        if motor.kind == MotorKind::OfActuator {
            return allows(&self.actuator_ids, &motor.id);
        }
        allows(&self.motor_kinds, &motor.kind) && allows(&self.motor_ids, &motor.id)
    }
}

fn allows<T: PartialEq>(list: &Option<Vec<T>>, item: &T) -> bool {
    list.as_ref().is_none_or(|list| list.contains(item))
}

/// A gear and a motor, as indices into the lists `gears` and `motors` of the table.
#[derive(Debug, Clone, Copy)]
struct Pair {
    gear: u32,
    motor: u32,
}

/// Every legal drive of one joint under its motion, lightest first. Drives of equal mass are sorted by the names of
/// gear and motor.
///
/// A drive that would turn too fast, or that lacks a rating that a check needs, is not in the table.
/// [`DriveTable::explain`] says why.
#[derive(Debug, Clone)]
pub struct DriveTable<'c> {
    joint: String,
    motion: JointMotion,
    gear_mass: GearMass,
    bearing: BearingSource,
    extras: ExtrasSource,
    stage: Stage,
    needs_torsion: bool,
    gears: Vec<&'c Gear>,
    motors: Vec<&'c Motor>,
    pairs: Vec<Pair>,
    masses_kg: Vec<f64>,
    limits: Vec<DriveLimits>,
    /// Indices of the drives that can be the lightest for some demand, lightest first. A drive is left out if a
    /// lighter one has no stricter limit.
    ladder: Vec<u32>,
    ladder_limits: Vec<DriveLimits>,
    /// For each step of the ladder, the most permissive value of each limit among the drives up to this step (the largest
    /// torque, the least heat, and so on). If a demand exceeds one of these values, no drive up to this step meets it, so
    /// the search for the lightest drive starts after it.
    ladder_reach: Vec<DriveLimits>,
    /// For each flight, the most permissive value of each limit among its steps. A flight is [`STEPS_OF_FLIGHT`]
    /// successive steps of the ladder.
    ladder_flights: Vec<DriveLimits>,
}

/// Number of successive steps of the ladder that form a flight. They are skipped together if even the most
/// permissive of their limits do not meet a demand.
const STEPS_OF_FLIGHT: usize = 8;

/// The ladder: the drives that can be the lightest for some demand, lightest first.
#[derive(Clone, Copy)]
pub(super) struct Ladder<'t> {
    pub indices: &'t [u32],
    pub limits: &'t [DriveLimits],
    pub reach: &'t [DriveLimits],
    flights: &'t [DriveLimits],
}

impl<'t> Ladder<'t> {
    /// The steps of the ladder from `start` on, in flights of [`STEPS_OF_FLIGHT`] steps: the most permissive limits
    /// of each flight, and the range of its steps.
    #[inline(always)]
    pub(super) fn flights_from(self, start: usize) -> impl Iterator<Item = (&'t DriveLimits, Range<usize>)> {
        let flights = self.flights.iter().enumerate().skip(start / STEPS_OF_FLIGHT);
        flights.map(move |(k, most)| {
            (most, (k * STEPS_OF_FLIGHT).max(start)..((k + 1) * STEPS_OF_FLIGHT).min(self.limits.len()))
        })
    }
}

impl<'c> DriveTable<'c> {
    /// Builds the table of the joint named `joint` from the gears and motors that `filter` allows.
    ///
    /// ```
    /// use armwright::catalog::Catalogs;
    /// use armwright::catalog::GearMass;
    /// use armwright::sizing::{DriveFilter, DriveTable, MotionRequirement};
    ///
    /// let catalogs = Catalogs::builtin();
    /// let motion = MotionRequirement::default().joint_motion(1.35, None);
    /// let mut filter = DriveFilter::everything(GearMass::ComponentSet);
    /// filter.gear_series = Some(vec!["HFUC".into()]);
    /// let table = DriveTable::build("j2", motion, &filter, &catalogs.gears, &catalogs.motors);
    /// // the lightest drive for 568 N m static torque and 290 N m more while accelerating
    /// let demand = motion.demand_of_torques(568.3, 289.7);
    /// let lightest = table.first_fit(&demand).expect("some drive holds");
    /// assert!(table.limits(lightest).hold(&demand));
    /// assert_eq!(table.all_fits(&demand).next(), Some(lightest));
    /// assert_eq!(table.first_fit(&demand.scaled(1000.0)), None);
    /// ```
    pub fn build(
        joint: &str,
        motion: JointMotion,
        filter: &DriveFilter,
        gears: &'c [Gear],
        motors: &'c [Motor],
    ) -> Self {
        let mut table = Self {
            joint: joint.to_string(),
            motion,
            gear_mass: filter.gear_mass,
            bearing: filter.bearing,
            extras: filter.extras,
            stage: filter.stage,
            needs_torsion: filter.needs_torsion,
            gears: gears.iter().filter(|g| filter.allows_gear(g)).collect(),
            motors: motors.iter().filter(|m| filter.allows_motor(m)).collect(),
            pairs: Vec::new(),
            masses_kg: Vec::new(),
            limits: Vec::new(),
            ladder: Vec::new(),
            ladder_limits: Vec::new(),
            ladder_reach: Vec::new(),
            ladder_flights: Vec::new(),
        };
        table.fill();
        table.raise_ladder();
        table
    }

    /// Fills the table with the pairs of gear and motor that may be chosen, the one with the least mass (extras
    /// included) first. Their mass is known, their torsion too if it is needed, no rating that a check needs is blank,
    /// and speeds, emergency stops and sizes are allowed.
    fn fill(&mut self) {
        let mut legal = Vec::new();
        for (drive, pair) in self.all_pairs().filter(|(drive, _)| self.knows_torsion(drive.gear)) {
            if let (Ok(limits), Ok(mass_kg)) =
                (DriveLimits::of(&drive, &self.motion), drive.mass_with_extras_kg())
            {
                legal.push((mass_kg, drive, pair, limits));
            }
        }
        // indices are sorted instead of the drives, because moving the large limits would take time; drives of equal
        // mass are in the order of their names, so that the order of the catalog files does not matter
        let mut places: Vec<usize> = (0..legal.len()).collect();
        places.sort_by(|&a, &b| {
            let (a, b) = (&legal[a], &legal[b]);
            a.0.total_cmp(&b.0).then_with(|| parts(&a.1).cmp(&parts(&b.1)))
        });
        for place in places {
            let (mass_kg, _, pair, limits) = &legal[place];
            self.pairs.push(*pair);
            self.masses_kg.push(*mass_kg);
            self.limits.push(*limits);
        }
    }

    /// Builds the ladder: the legal drives that can be the lightest one for some demand, lightest first.
    fn raise_ladder(&mut self) {
        for index in 0..self.limits.len() {
            let limits = self.limits[index];
            // a drive is covered if a lighter one meets every demand that it meets; it is then never the lightest
            if self.is_covered(&limits) {
                continue;
            }
            if self.ladder.len().is_multiple_of(STEPS_OF_FLIGHT) {
                self.ladder_flights.push(limits);
            } else if let Some(most) = self.ladder_flights.last_mut() {
                *most = most.max(&limits);
            }
            self.ladder.push(index as u32);
            self.ladder_limits.push(limits);
            self.ladder_reach.push(self.ladder_reach.last().map_or(limits, |reach| reach.max(&limits)));
        }
    }

    /// Whether some step of the ladder covers `limits`: none of its limits is stricter than the same limit of `limits`.
    /// If the most permissive limits of a flight do not cover `limits`, no step of the flight does, and the flight is skipped.
    fn is_covered(&self, limits: &DriveLimits) -> bool {
        let flights = self.ladder_flights.iter().zip(self.ladder_limits.chunks(STEPS_OF_FLIGHT));
        let mut near = flights.filter(|(most, _)| most.cover(limits)).flat_map(|(_, flight)| flight);
        near.any(|lighter| lighter.cover(limits))
    }

    fn all_pairs(&self) -> impl Iterator<Item = (Drive<'c>, Pair)> + '_ {
        let motors = 0..self.motors.len() as u32;
        let pairs = (0..self.gears.len() as u32)
            .flat_map(move |gear| motors.clone().map(move |motor| Pair { gear, motor }));
        let drives = pairs.map(|pair| (self.drive_of(pair), pair));
        drives.filter(|(drive, _)| drive.gear.goes_with(drive.motor))
    }

    fn drive_of(&self, pair: Pair) -> Drive<'c> {
        self.pair(self.gears[pair.gear as usize], self.motors[pair.motor as usize])
    }

    /// The drive that a gear and a motor make in this joint.
    pub(crate) fn pair(&self, gear: &'c Gear, motor: &'c Motor) -> Drive<'c> {
        Drive {
            gear,
            motor,
            gear_mass: self.gear_mass,
            bearing: self.bearing,
            extras: self.extras,
            stage: self.stage,
        }
    }

    /// Where the output bearing of the joint comes from: from the gear, or stated by the study.
    pub(super) fn bearing_source(&self) -> &BearingSource {
        &self.bearing
    }

    /// The output bearing of the joint if `gear` is its gear; `None` if the joint then has no bearing.
    pub(super) fn bearing_of(&self, gear: &Gear) -> Option<Bearing> {
        self.bearing.with_gear(gear, self.gear_mass)
    }

    /// Whether `gear` may be used as far as its torsion curve is concerned: the curve is known, or the joint does not
    /// need it because no deflection is computed.
    pub(super) fn knows_torsion(&self, gear: &Gear) -> bool {
        !self.needs_torsion || gear.missing_of_torsion().is_empty()
    }

    /// Name of the joint.
    pub fn joint(&self) -> &str {
        &self.joint
    }

    /// Motion of the joint.
    pub fn motion(&self) -> &JointMotion {
        &self.motion
    }

    /// Which mass of a gear counts: component set or housed unit.
    pub fn gear_mass(&self) -> GearMass {
        self.gear_mass
    }

    /// Gears that the filter allows, whether or not they are in a legal drive.
    pub fn gears(&self) -> &[&'c Gear] {
        &self.gears
    }

    /// Motors that the filter allows, whether or not they are in a legal drive.
    pub fn motors(&self) -> &[&'c Motor] {
        &self.motors
    }

    /// Number of legal drives.
    pub fn len(&self) -> usize {
        self.pairs.len()
    }

    /// Whether no drive is legal.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// The drive with the index `index` in the table.
    pub fn drive(&self, index: usize) -> Drive<'c> {
        self.drive_of(self.pairs[index])
    }

    /// The drive with the index `index`. If the table has none, it is the first pair that the filter allows, which
    /// turns too fast or lacks a rating; `None` if the filter allows no pair.
    pub(crate) fn drive_or_illegal(&self, index: usize) -> Option<Drive<'c>> {
        self.pairs.get(index).map(|pair| self.drive_of(*pair)).or_else(|| self.all_drives().next())
    }

    /// Mass of gear, motor and extras (housing, brake, encoders, flange, cables) of the drive with the index `index`
    /// \[kg\].
    #[inline]
    pub fn mass_kg(&self, index: usize) -> f64 {
        self.masses_kg[index]
    }

    /// Thresholds of torque, load and size of the drive with the index `index`.
    #[inline]
    pub fn limits(&self, index: usize) -> &DriveLimits {
        &self.limits[index]
    }

    /// Whether the table has a drive at `index` and this drive meets `demand`.
    #[inline]
    pub(crate) fn holds(&self, index: usize, demand: &JointDemand) -> bool {
        self.limits.get(index).is_some_and(|limits| limits.hold(demand))
    }

    /// Index of the legal drive with these names of gear and motor; `None` if there is none.
    pub fn index_of(&self, gear_id: &str, motor_id: &str) -> Option<usize> {
        (0..self.len()).find(|&i| parts(&self.drive(i)) == (gear_id, motor_id))
    }

    /// Indices of the drives that can be the lightest for some demand, lightest first. A drive is left out if a
    /// lighter one has no stricter limit.
    pub fn first_fit_candidates(&self) -> &[u32] {
        &self.ladder
    }

    /// Index of the lightest drive that meets `demand`; `None` if no drive does. The paper chooses drives in this way.
    #[inline]
    pub fn first_fit(&self, demand: &JointDemand) -> Option<usize> {
        let start = self.first_step_within_reach(demand);
        let step = start + self.ladder_limits[start..].iter().position(|limits| limits.hold(demand))?;
        Some(self.ladder[step] as usize)
    }

    /// The drives that can be the lightest for some demand, with their limits.
    pub(super) fn ladder(&self) -> Ladder<'_> {
        Ladder {
            indices: &self.ladder,
            limits: &self.ladder_limits,
            reach: &self.ladder_reach,
            flights: &self.ladder_flights,
        }
    }

    /// The first step of the ladder for which some drive up to this step may meet `demand`. Most demands are met near
    /// the beginning. Therefore the stride is doubled until the step is passed, and then the interval is bisected.
    #[inline]
    fn first_step_within_reach(&self, demand: &JointDemand) -> usize {
        let reach = &self.ladder_reach;
        let (mut low, mut high) = (0, 1);
        while high < reach.len() && !reach[high - 1].hold(demand) {
            (low, high) = (high, 2 * high);
        }
        low + reach[low..high.min(reach.len())].partition_point(|reach| !reach.hold(demand))
    }

    /// Indices of all drives that meet `demand`, lightest first.
    #[inline]
    pub fn all_fits<'t>(&'t self, demand: &'t JointDemand) -> impl Iterator<Item = usize> + 't {
        let holding = self.limits.iter().enumerate().filter(|(_, limits)| limits.hold(demand));
        holding.map(|(index, _)| index)
    }

    /// Every pair of gear and motor that the filter allows, even if it turns too fast or lacks a rating.
    pub(super) fn all_drives(&self) -> impl Iterator<Item = Drive<'c>> + '_ {
        self.all_pairs().map(|(drive, _)| drive)
    }
}

fn parts<'c>(drive: &Drive<'c>) -> (&'c str, &'c str) {
    (&drive.gear.id, &drive.motor.id)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{
        any_gear, any_link_m, any_motion, any_motor, any_torques, bearing_loads, char_lynn_j_8_2, f11_10,
    };
    use super::super::testing::{hfuc_40_100, hfuc_58_100, motor};
    use super::*;
    use crate::sizing::checks::{all_hold, checks};
    use crate::sizing::requirement::MotionRequirement;
    use proptest::prelude::*;

    fn everything() -> DriveFilter {
        DriveFilter::everything(GearMass::ComponentSet)
    }

    fn motion() -> JointMotion {
        MotionRequirement::default().joint_motion(1.35, None)
    }

    #[test]
    fn the_first_fit_is_the_lightest_drive_that_holds() {
        let (gears, motors) = ([hfuc_58_100(), hfuc_40_100()], [f11_10()]);
        let table = DriveTable::build("j2", motion(), &everything(), &gears, &motors);
        let fit = |static_nm: f64| {
            let index = table.first_fit(&motion().demand_of_torques(static_nm, 0.5 * static_nm))?;
            Some((table.drive(index).gear.id.clone(), table.mass_kg(index)))
        };
        assert_eq!(fit(300.0), Some(("HFUC-40-100".to_string(), 9.2)));
        assert_eq!(fit(568.3), Some(("HFUC-58-100".to_string(), 12.2)));
        assert_eq!(fit(2000.0), None);
    }

    #[test]
    fn a_part_that_lacks_a_rating_has_no_index() {
        let (gears, motors) = ([hfuc_40_100()], [char_lynn_j_8_2()]);
        let table = DriveTable::build("j4", motion(), &everything(), &gears, &motors);
        assert!(table.is_empty());
        assert_eq!(table.first_fit(&motion().demand_of_torques(0.0, 0.0)), None);
    }

    #[test]
    fn equal_masses_are_ordered_by_name_whatever_the_order_of_the_lists() {
        let gears = [hfuc_40_100()];
        let same = |id| motor(id, [31.0, 62.0], [3000.0, 5000.0], 0.0003, 5.0);
        for motors in [[same("B"), same("A")], [same("A"), same("B")]] {
            let table = DriveTable::build("j2", motion(), &everything(), &gears, &motors);
            assert_eq!(table.drive(0).motor.id, "A");
            assert_eq!(table.first_fit_candidates(), [0], "B holds no more than A");
            assert_eq!(table.index_of("HFUC-40-100", "B"), Some(1));
        }
    }

    #[test]
    fn a_filter_keeps_series_ratios_kinds_and_names() {
        let (gears, motors) = ([hfuc_58_100(), hfuc_40_100()], [f11_10(), char_lynn_j_8_2()]);
        let count = |change: fn(&mut DriveFilter)| {
            let mut filter = everything();
            change(&mut filter);
            let table = DriveTable::build("j2", motion(), &filter, &gears, &motors);
            (table.gears().len(), table.motors().len())
        };
        assert_eq!(count(|_| ()), (2, 2));
        assert_eq!(count(|f| f.gear_series = Some(vec!["CSG".into()])), (0, 2));
        assert_eq!(count(|f| f.ratios = Some(vec![100.0])), (2, 2));
        assert_eq!(count(|f| f.gear_ids = Some(vec!["HFUC-40-100".into()])), (1, 2));
        assert_eq!(count(|f| f.motor_kinds = Some(vec![MotorKind::HydraulicOrbital])), (2, 1));
        assert_eq!(count(|f| f.motor_ids = Some(vec!["none".into()])), (2, 0));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        #[test]
        fn fits_are_the_pairs_whose_checks_all_hold_and_the_first_is_the_lightest(
            gears in prop::collection::vec(any_gear(), 1..8),
            motors in prop::collection::vec(any_motor(), 1..8),
            motion in any_motion(),
            torques in any_torques(),
            link_m in any_link_m(),
            housed: bool,
        ) {
            let gear_mass = if housed { GearMass::HousedUnit } else { GearMass::ComponentSet };
            let gears: Vec<_> = gears.into_iter().enumerate().map(|(i, g)| Gear { id: format!("G{i}"), ..g }).collect();
            let motors: Vec<_> = motors.into_iter().enumerate().map(|(i, m)| Motor { id: format!("M{i}"), ..m }).collect();
            let demand = motion
                .demand_of_torques(torques[0] / 2.0, torques[1] / 4.0)
                .with_bearing(bearing_loads(torques[2]))
                .with_room(motion.fit.room(link_m[0], [link_m[1], 0.8 * link_m[1]]));
            let table = DriveTable::build("j", motion, &DriveFilter::everything(gear_mass), &gears, &motors);
            let mut slow = Vec::new();
            for gear in &gears {
                for motor in &motors {
                    let drive = Drive { gear, motor, gear_mass, bearing: BearingSource::OfGear, extras: ExtrasSource::NONE, stage: Stage::NONE };
                    if all_hold(&checks(&drive, &motion, &demand)) {
                        slow.push((drive.mass_kg().unwrap(), gear.id.clone(), motor.id.clone()));
                    }
                }
            }
            slow.sort_by(|a, b| a.partial_cmp(b).unwrap());
            let fits: Vec<_> = table.all_fits(&demand).map(|i| {
                let drive = table.drive(i);
                (table.mass_kg(i), drive.gear.id.clone(), drive.motor.id.clone())
            }).collect();
            prop_assert_eq!(&fits, &slow);
            prop_assert_eq!(table.first_fit(&demand), table.all_fits(&demand).next());
        }
    }
}
