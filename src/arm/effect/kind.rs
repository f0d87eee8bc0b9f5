//! What is known of an effect before any arm has it: its name, its places, its parameters, its law, and the
//! answers that the search for effects and the studies ask of it.

use super::channel::Channel;
use super::subject::Subject;

/// What kind of place an effect sits at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A joint, by name.
    Joint,
    /// A link, by name.
    Link,
    /// A link that is a tube, by name.
    Tube,
    /// `base`.
    Base,
    /// `payload`.
    Payload,
    /// `arm`.
    Arm,
    /// A channel: `static`, `modal`, `windup` or `positions`.
    Channel(Channel),
}

/// What an effect belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// The product: every calculation uses the effect.
    Product,
    /// The test: only `predict` and `reconcile` use the effect.
    Test,
}

/// How a fit moves a parameter: the number `u` that it varies, and the parameter's value at `u`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// `u` is the value over the parameter's typical size.
    Linear,
    /// `u` is the compliance over that of the joint where the effect sits; the value is a stiffness.
    Stiffness,
    /// `u` is the reciprocal of the value, which is a factor on a stiffness.
    Reciprocal,
    /// `u` is the natural logarithm of the value.
    Log,
    /// `u` is the value, a torque, over the largest torque on the joint in the campaign.
    Torque,
}

/// The value at which the effect is absent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Absent {
    /// 0: no size, or no compliance.
    AtZero,
    /// 1: a factor that changes nothing.
    AtOne,
    /// None: the parameter says how the effect acts and not how large it is.
    Never,
}

/// A measure of the arm or of its readings with which the expected size of a parameter grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Mass of the arm \[kg\].
    ArmMass,
    /// Mass of the arm over the length of its links \[kg/m\].
    ArmMassPerLength,
    /// Mass of the heaviest payload \[kg\].
    PayloadMass,
    /// Largest displacement reading \[mm\].
    Displacement,
    /// Largest displacement reading over the number of static rows \[mm\].
    DisplacementPerRow,
    /// Largest wind-up reading \[arcmin\].
    Twist,
    /// Largest displacement reading over the length of the links, or largest wind-up reading \[rad\].
    Angle,
}

/// A parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name with unit, as files write it.
    pub name: &'static str,
    /// How many numbers it has: 1, or 3 for a vector.
    pub count: usize,
    /// Smallest sensible value.
    pub low: f64,
    /// Largest sensible value.
    pub high: f64,
    /// A typical value, where a fit starts.
    pub typical: f64,
    /// Where a fit expects it, every value as likely as another. A stiffness is given as the compliance over
    /// that of its joint, a reciprocal as `1/factor`, a torque as part of the largest on its joint.
    pub prior: (f64, f64),
    /// How a fit moves it.
    pub scale: Scale,
    /// The value at which the effect is absent.
    pub absent: Absent,
    /// The value when it is left out. A parameter with a default is stated and not fitted.
    pub default: Option<f64>,
    /// Whether it names a channel. Files have the channel's word; here it is the channel's number.
    pub is_channel: bool,
    /// Another parameter that this one is not below.
    pub not_below: Option<&'static str>,
    /// The measure of the arm or of its readings with which the expected size grows, and the part of it
    /// that is expected.
    pub grows_with: Option<(Measure, f64)>,
    /// The largest value that a search looks for in an arm and a campaign of usual size, if that is less than the
    /// largest sensible one.
    pub sought_up_to: Option<f64>,
    /// The limits of a torque, as parts of the largest torque on its joint in the campaign. A law that changes
    /// where no torque reaches cannot be told from another.
    pub torque_parts: Option<(f64, f64)>,
}

impl Parameter {
    /// A single number that must be given.
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

    /// Three numbers that must be given.
    pub const fn vector(name: &'static str, low: f64, high: f64, typical: f64) -> Self {
        Self { count: 3, ..Self::number(name, low, high, typical, Scale::Linear) }
    }

    /// The same parameter, expected within narrower limits.
    pub const fn expected(self, low: f64, high: f64) -> Self {
        Self { prior: (low, high), ..self }
    }

    /// The same parameter, not below another.
    pub const fn at_least(self, other: &'static str) -> Self {
        Self { not_below: Some(other), ..self }
    }

    /// The same parameter, with the effect absent at another value than its scale suggests.
    pub const fn absent(self, absent: Absent) -> Self {
        Self { absent, ..self }
    }

    /// The same parameter, expected larger where this part of a measure is larger.
    pub const fn growing_with(self, measure: Measure, part: f64) -> Self {
        Self { grows_with: Some((measure, part)), ..self }
    }

    /// The same parameter, looked for up to this value where arm and readings are of usual size.
    pub const fn sought_up_to(self, high: f64) -> Self {
        Self { sought_up_to: Some(high), ..self }
    }

    /// The same torque, within these parts of the largest torque on its joint.
    pub const fn within_torque(self, low: f64, high: f64) -> Self {
        Self { torque_parts: Some((low, high)), ..self }
    }
}

/// What an effect needs of the nominal model at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needs {
    /// Nothing.
    Nothing,
    /// A joint that the model holds rigid: the effect is what such a model lacks.
    RigidJoint,
    /// A joint that twists: the effect acts in series with its gear.
    TwistingJoint,
    /// A driven joint that twists.
    DrivenTwist,
    /// A driven joint whose twist is not in proportion to its torque.
    CurvedJoint,
    /// A link that the model holds rigid.
    RigidLink,
    /// A link that bends.
    BendingLink,
}

/// The mass that an effect can take away, beyond which nothing would be left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Removes {
    /// The mass of the joint where it sits.
    JointMass,
    /// The mass of the payload.
    PayloadMass,
}

/// What turns under gravity where the effect sits, as absolute positions show it. The order is that in which
/// positions are searched: an effect of a later class can imitate those of the classes before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Yields {
    /// A joint about its axis.
    AboutAxis,
    /// A joint across its axis, or the base about both horizontal axes, equally.
    Tilt,
    /// The base or the structure behind a joint, about three axes that are coupled.
    Frame,
}

/// A parameter that a search frees: its name, and one component of it or all.
pub type Freed = (&'static str, Option<usize>);

/// How likely a search takes an effect to be before any reading, compared with a usual one, if it is seldom met.
pub const RARE: f64 = 0.3;

/// What is known of a joint in a campaign when an effect there proposes starting points for a fit.
pub struct Setting<'a> {
    /// Largest torque on the joint in the campaign, at least 1 \[N m\].
    pub torque_nm: f64,
    /// The twist of the joint under that torque \[rad\].
    pub twist_rad: f64,
    /// Number of rows of the longest file of readings of the whole arm.
    pub rows: f64,
    /// The value of each fitted number at `u = 1`.
    pub values_at_one: &'a [f64],
}

/// Answers that reconcile and the studies ask of a kind. Most kinds change few of [`Traits::USUAL`].
pub struct Traits {
    /// Whether a search for effects tries the kind at every place.
    pub is_sought: bool,
    /// The channels at which, or in which, the search tries a kind of channels; all if there are none here.
    pub sought_in: &'static [Channel],
    /// The sets of parameters that the search frees, each a candidate of its own. If there are none, it frees every
    /// parameter without a default.
    pub variants: &'static [&'static [Freed]],
    /// How likely the search takes it to be before any reading, compared with a usual effect at one place.
    pub odds: f64,
    /// What the nominal model must be like for the search to try it.
    pub needs: Needs,
    /// Where fits start, each a list of `u` by number.
    pub starts: fn(&Setting) -> Vec<Vec<f64>>,
    /// Whether the readings follow its parameters so crookedly that a confidence interval must follow the
    /// profile of the objective.
    pub is_nonlinear: bool,
    /// Whether a screening keeps the numbers that say how it acts at their starts: far from there the linear model misleads.
    pub screens_at_starts: bool,
    /// Whether it replaces the torsion curve of a gear, with break points at which frequencies step.
    pub is_gear_curve: bool,
    /// Whether it changes the torques at which gears vibrate, so that frequencies step.
    pub moves_working_points: bool,
    /// Whether it changes how a link bends.
    pub changes_bending: bool,
    /// Whether the bounds of the exact search, of the verifier and of the relaxation know its law.
    pub in_bounds: bool,
    /// The mass that it can take away.
    pub removes: Option<Removes>,
    /// What yields under gravity, if absolute positions are searched for it.
    pub yields: Option<Yields>,
    /// The effect at the first joint that is the same thing where that joint is vertical.
    pub same_at_vertical_first_joint: Option<&'static str>,
    /// What is wrong with numbers that are each within bounds: the problem and what to try.
    pub contradiction: fn(&[f64]) -> Option<(&'static str, &'static str)>,
}

impl Traits {
    /// What most kinds answer.
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
        yields: None,
        same_at_vertical_first_joint: None,
        contradiction: |_| None,
    };
}

impl Traits {
    /// Whether frequencies step as its parameters change.
    pub fn steps_frequencies(&self) -> bool {
        self.is_gear_curve || self.moves_working_points
    }
}

/// What is known of an effect before any arm has it.
pub struct Kind {
    /// Name in files.
    pub name: &'static str,
    /// One line on what it is.
    pub summary: &'static str,
    /// Product or test.
    pub scope: Scope,
    /// Where it can sit.
    pub places: &'static [Place],
    /// Its parameters at such a place.
    pub parameters: fn(Place) -> &'static [Parameter],
    /// Puts it into the subject: the numbers of all parameters in order, and the place's name.
    pub apply: fn(&[f64], &str, &mut Subject),
    /// What reconcile and the studies ask of it.
    pub traits: Traits,
}
