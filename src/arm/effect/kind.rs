//! The description of a kind of effect: its name, its places, its parameters, how it changes an arm, and properties
//! that the search for effects and the studies use.

use super::channel::Channel;
use super::subject::Subject;

/// The kinds of places at which an effect can be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A revolute joint, by name.
    Joint,
    /// A prismatic joint, by name.
    Prismatic,
    /// A link, by name.
    Link,
    /// A link that is a tube, by name.
    Tube,
    /// The base of the arm; the word in files is `base`.
    Base,
    /// The payload; the word in files is `payload`.
    Payload,
    /// The whole arm; the word in files is `arm`.
    Arm,
    /// A measuring channel, by its word: `static`, `modal`, `windup` or `positions`.
    Channel(Channel),
}

/// Whether an effect belongs to the product or to the test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// The product: every calculation uses the effect.
    Product,
    /// The test: only `predict` and `reconcile` use the effect.
    Test,
}

/// How a fit varies a parameter: the relation between the variable `u` of the fit and the value of the parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// `u` is the value divided by the parameter's typical value.
    Linear,
    /// The value is a stiffness. `u` is its compliance divided by the compliance of the joint at which the effect is.
    Stiffness,
    /// The value is a factor on a stiffness. `u` is its reciprocal.
    Reciprocal,
    /// `u` is the natural logarithm of the value.
    Log,
    /// The value is a torque. `u` is the value divided by the largest torque on the joint in the campaign.
    Torque,
}

/// The value of a parameter at which its effect changes nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Absent {
    /// The value 0: an amplitude of zero, or no compliance.
    AtZero,
    /// The value 1: a factor that changes nothing.
    AtOne,
    /// No such value: the parameter says how the effect acts and not how large it is.
    Never,
}

/// A property of the arm or of its readings to which the expected size of a parameter is proportional.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Mass of the arm \[kg\].
    ArmMass,
    /// Mass of the arm divided by the sum of the lengths of its links \[kg/m\].
    ArmMassPerLength,
    /// Mass of the heaviest payload \[kg\].
    PayloadMass,
    /// Largest displacement reading \[mm\].
    Displacement,
    /// Largest displacement reading divided by the number of static rows \[mm\].
    DisplacementPerRow,
    /// Largest wind-up reading \[arcmin\].
    Twist,
    /// Largest displacement reading divided by the sum of the lengths of the links, or the largest wind-up reading if
    /// that is larger \[rad\].
    Angle,
}

/// A parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name with unit, as files write it.
    pub name: &'static str,
    /// Number of values: 1, more for a vector, or 0 for a list of any length.
    pub count: usize,
    /// Smallest value that a file may give for an arm of usual size.
    pub low: f64,
    /// Largest value that a file may give for an arm of usual size.
    pub high: f64,
    /// A typical value. With the scale [`Scale::Linear`] it is the value at `u = 1`.
    pub typical: f64,
    /// Range in which a fit expects the parameter, with equal probability everywhere in it. The ends of the range are
    /// values of the parameter, except for three scales ([`Scale`]). For a stiffness they are compliances, divided by
    /// the compliance of the joint. For a factor on a stiffness they are reciprocals of the factor. For a torque they
    /// are fractions of the largest torque on the joint.
    pub prior: (f64, f64),
    /// How a fit varies the parameter.
    pub scale: Scale,
    /// The value at which the effect changes nothing.
    pub absent: Absent,
    /// The value that the parameter has if a file leaves it out; `None` if a file must give it. A parameter with a
    /// default is stated and not fitted, unless a variant names it.
    pub default: Option<f64>,
    /// Whether the value is a channel. Files write the word of the channel; here it is the index of the channel.
    pub is_channel: bool,
    /// Name of another parameter that is a lower limit of this parameter; `None` if there is none.
    pub not_below: Option<&'static str>,
    /// A property of the arm or its readings to which the expected size of this parameter is proportional, and the
    /// factor of proportionality. `None` if the expected size depends on neither.
    pub grows_with: Option<(Measure, f64)>,
    /// The largest value for which a search looks in an arm and a campaign of usual size. `None`: the largest value
    /// that a file may give.
    pub sought_up_to: Option<f64>,
    /// If the parameter is a torque: the limits between which a search looks for its value, as fractions of the largest
    /// torque on the joint in the campaign. A change of the joint law beyond the torques that occur could not be
    /// recognized. `None` for parameters that are no torque.
    pub torque_parts: Option<(f64, f64)>,
}

impl Parameter {
    /// Smallest and largest value that a file may give. Where the expected size grows with the arm, both are those of
    /// an arm that is much larger than usual.
    pub(crate) fn readable(&self) -> (f64, f64) {
        match self.grows_with {
            Some(_) if self.sought_up_to.is_none() => (LARGEST_GROWTH * self.low, LARGEST_GROWTH * self.high),
            _ => (self.low, self.high),
        }
    }

    /// Whether a file may give this value.
    pub(crate) fn allows(&self, value: f64) -> bool {
        let (low, high) = self.readable();
        (low..=high).contains(&value)
    }

    /// The value next to `value` that a file may give.
    pub(crate) fn nearest(&self, value: f64) -> f64 {
        let (low, high) = self.readable();
        value.clamp(low, high)
    }

    /// A parameter with a single value that a file must give, between `low` and `high`. `typical` is a usual value, and
    /// `scale` says how a fit varies the parameter.
    pub const fn number(name: &'static str, low: f64, high: f64, typical: f64, scale: Scale) -> Self {
        let absent = match scale {
            Scale::Linear | Scale::Stiffness | Scale::Torque => Absent::AtZero,
            Scale::Reciprocal => Absent::AtOne,
            Scale::Log => Absent::Never,
        };
        Self {
            name,
            count: 1,
            low,
            high,
            typical,
            prior: (low, high),
            scale,
            absent,
            default: None,
            is_channel: false,
            not_below: None,
            grows_with: None,
            sought_up_to: None,
            torque_parts: None,
        }
    }

    /// A parameter with three values that a file must give, each between `low` and `high`. `typical` is a usual value.
    pub const fn vector(name: &'static str, low: f64, high: f64, typical: f64) -> Self {
        Self { count: 3, ..Self::number(name, low, high, typical, Scale::Linear) }
    }

    /// This parameter, with `low` to `high` as the range in which a fit expects its value, in place of the whole range
    /// of allowed values.
    pub const fn expected(self, low: f64, high: f64) -> Self {
        Self { prior: (low, high), ..self }
    }

    /// This parameter, which must not be smaller than the parameter named `other`.
    pub const fn at_least(self, other: &'static str) -> Self {
        Self { not_below: Some(other), ..self }
    }

    /// This parameter, with `absent` as the value at which the effect changes nothing, in place of the value that
    /// follows from its scale.
    pub const fn absent(self, absent: Absent) -> Self {
        Self { absent, ..self }
    }

    /// This parameter, with an expected size of `part` times the property `measure` of the arm or of its readings.
    pub const fn growing_with(self, measure: Measure, part: f64) -> Self {
        Self { grows_with: Some((measure, part)), ..self }
    }

    /// This parameter, for which a search looks only up to `high` if arm and readings are of usual size. Files may give
    /// larger values.
    pub const fn sought_up_to(self, high: f64) -> Self {
        Self { sought_up_to: Some(high), ..self }
    }

    /// This parameter, a torque, for which a search looks only between the fractions `low` and `high` of the largest
    /// torque on its joint.
    pub const fn within_torque(self, low: f64, high: f64) -> Self {
        Self { torque_parts: Some((low, high)), ..self }
    }
}

/// The property that the nominal model must have at a place so that an effect is possible at this place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needs {
    /// Nothing: the effect is possible at every place of its kind.
    Nothing,
    /// A joint that is rigid in the model: the effect adds the missing compliance.
    RigidJoint,
    /// A joint with compliance: the effect acts in series with the gear.
    TwistingJoint,
    /// A driven joint with compliance.
    DrivenTwist,
    /// A driven joint whose angle of torsion is not proportional to its torque.
    CurvedJoint,
    /// A link that is rigid in the model.
    RigidLink,
    /// A link that bends in the model.
    BendingLink,
}

/// A mass that an effect can reduce. The effect must not reduce it below zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Removes {
    /// The mass of the joint at which the effect is.
    JointMass,
    /// The mass of the payload.
    PayloadMass,
}

/// Class of the elastic rotation that an effect adds under gravity, as readings of absolute positions show it. A search
/// of positions tries the classes in this order, because an effect of a later class can explain the same
/// readings as an effect of a class before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ElasticRotation {
    /// Rotation of a joint about its axis.
    AboutAxis,
    /// Tilt of a joint about the two axes perpendicular to its axis, or of the base about both horizontal axes, with
    /// equal compliance.
    Tilt,
    /// Rotation of the base, or of the structure between a joint and the link outboard of it, about three axes, with
    /// coupling.
    Frame,
}

/// A parameter that a search fits: its name, and the index of one of its numbers, or `None` for all of its numbers.
pub type Freed = (&'static str, Option<usize>);

/// The places of an effect that can be at every measuring channel.
pub(super) const EVERY_CHANNEL: &[Place] = &[
    Place::Channel(Channel::Static),
    Place::Channel(Channel::Modal),
    Place::Channel(Channel::Windup),
    Place::Channel(Channel::Positions),
];

/// How many times larger than usual an arm or its readings may be, for the limits of parameters that grow with them.
const LARGEST_GROWTH: f64 = 100.0;

/// Prior probability of a rare effect divided by the prior probability of a usual effect. A prior probability is the
/// probability before any reading is considered.
pub const RARE_PRIOR: f64 = 0.3;

/// Properties of a joint in a campaign, from which an effect at this joint derives the starting points of a fit.
pub struct Setting<'a> {
    /// Largest torque on the joint in the campaign, at least 1 \[N m\].
    pub torque_nm: f64,
    /// Angle of torsion of the joint under this torque \[rad\].
    pub twist_rad: f64,
    /// Number of rows of the longest file of readings of the whole arm (not of a bench).
    pub rows: f64,
    /// The value of each fitted number at which the variable `u` of the fit is 1, see [`Scale`].
    pub values_at_one: &'a [f64],
}

/// Properties of an effect that `reconcile` and the studies use. Most effects differ from [`Traits::USUAL`] in a few
/// only.
pub struct Traits {
    /// Whether a search for effects tries this effect at every place.
    pub is_sought: bool,
    /// The channels in which the search tries an effect that belongs to one channel. Empty means all channels.
    pub sought_in: &'static [Channel],
    /// The sets of parameters that the search fits. Each set is a candidate of its own. Empty means a single set: every
    /// parameter without a default.
    pub variants: &'static [&'static [Freed]],
    /// Prior probability of the effect, relative to a usual effect at one place, before any reading is considered.
    pub odds: f64,
    /// The property that the nominal model must have at a place so that the search tries the effect at this place.
    pub needs: Needs,
    /// Starting points of fits. Each is a list of values of the fit's variable `u` ([`Scale`]), one for each fitted
    /// number.
    pub starts: fn(&Setting) -> Vec<Vec<f64>>,
    /// Whether the readings depend on the parameters so nonlinearly that a confidence interval must be computed from
    /// the profile of the objective.
    pub is_nonlinear: bool,
    /// Whether screening, which is a linear fit, leaves some parameters at their starting points. These parameters say
    /// how the effect acts, and not how large it is. Far from the starting points the linear model is wrong.
    pub screens_at_starts: bool,
    /// Whether the effect replaces the torsion curve of a gear. Natural frequencies jump at its break points.
    pub is_gear_curve: bool,
    /// Whether the effect changes the static torques on gears. Natural frequencies then jump where a torque passes a
    /// break point.
    pub moves_working_points: bool,
    /// Whether the effect changes how a link bends.
    pub changes_bending: bool,
    /// Whether the bounds of the exact search, of the verifier and of the linear program for mass bounds include this
    /// effect.
    pub in_bounds: bool,
    /// The mass that the effect can reduce; `None` if it reduces none.
    pub removes: Option<Removes>,
    /// The elastic rotation under gravity by which absolute positions show the effect; `None` if positions are not
    /// searched for it.
    pub rotation: Option<ElasticRotation>,
    /// Name of an effect at the first joint that has the same consequences as this effect if the axis of this joint is
    /// vertical; `None` if there is no such effect.
    pub same_at_vertical_first_joint: Option<&'static str>,
    /// Finds a contradiction between the values of all parameters, each of which is within its limits. Returns the
    /// problem and the advice; `None` if there is no contradiction.
    pub contradiction: fn(&[f64]) -> Option<(&'static str, &'static str)>,
    /// Replaces, in place, fitted numbers that no arm can have, such as amplitudes whose sum is too large, by numbers
    /// near them that an arm can have.
    pub bounded: fn(&mut [f64]),
}

impl Traits {
    /// The properties that most effects have. The description of an effect states only what differs from them.
    pub const USUAL: Self = Self {
        is_sought: true,
        sought_in: &[],
        variants: &[],
        odds: 1.0,
        needs: Needs::Nothing,
        starts: |setting| vec![vec![1.0; setting.values_at_one.len()]],
        is_nonlinear: false,
        screens_at_starts: false,
        is_gear_curve: false,
        moves_working_points: false,
        changes_bending: false,
        in_bounds: true,
        removes: None,
        rotation: None,
        same_at_vertical_first_joint: None,
        contradiction: |_| None,
        bounded: |_| {},
    };
}

impl Traits {
    /// Whether natural frequencies jump as the parameters of the effect change.
    pub fn steps_frequencies(&self) -> bool {
        self.is_gear_curve || self.moves_working_points
    }
}

/// The description of a kind of effect, independent of any arm.
pub struct Kind {
    /// Name in files.
    pub name: &'static str,
    /// One line that says what the effect is.
    pub summary: &'static str,
    /// Whether the effect belongs to the product or to the test.
    pub scope: Scope,
    /// The kinds of places at which the effect can be.
    pub places: &'static [Place],
    /// The parameters of the effect at a place of the given kind.
    pub parameters: fn(Place) -> &'static [Parameter],
    /// Applies the effect to a subject. The arguments are the values of all parameters in order, and the name of the
    /// place.
    pub apply: fn(&[f64], &str, &mut Subject),
    /// Properties that `reconcile` and the studies use.
    pub traits: Traits,
}

impl Kind {
    /// The parameter named `name`, at the first kind of place that has it.
    pub(crate) fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.places.iter().flat_map(|place| (self.parameters)(*place)).find(|p| p.name == name)
    }
}
