//! One picked design: a drawing of its arm to scale, the elements that cause its deflection, its modes and its
//! drives.

use super::gallery::{Gallery, table};
use crate::arm::load::LoadCase;
use crate::arm::pieces::without_factors;
use crate::arm::springs::Drawn;
use crate::arm::{Arm, Element, Link, LinkBody};
use crate::mechanics::centre_line::Station;
use crate::mechanics::chain::{Chain, Posed};
use crate::mechanics::modes::Mode;
use crate::mechanics::statics::Statics;
use crate::report::file_names::file_name;
use crate::report::number::{cost_words, fixed, percent, shortest, significant};
use crate::report::picks::Pick;
use crate::report::pose::pose_signs;
use crate::report::section::Figure;
use crate::report::springs::springs_in;
use crate::report::svg::arm::{ArmSketch, Pivot, Place, Tube};
use crate::report::svg::bars::{Bar, Part, StackedBars};
use crate::report::table::{Column, Table};
use crate::report::tube::section_size;
use crate::sizing::check::{Check, CheckKind, CheckState};
use crate::sizing::sheet::JointSizingRow;
use nalgebra::Vector3;
use serde_json::{Value, json};

/// Number of modes that are drawn.
const MODES_DRAWN: usize = 3;
/// The arm is drawn from above if its motion out of the vertical plane is at least this fraction of the largest
/// motion.
const SIDEWAYS_SHARE: f64 = 0.5;

/// A picked design with everything that its card on the page shows.
#[derive(Debug, Clone, PartialEq)]
pub struct PickedArm {
    /// What the design is picked for, and its objectives.
    pub pick: Pick,
    /// The arm of the design, with all parts as numbers.
    pub arm: Arm,
    /// The cases in which the design was judged.
    pub cases: Vec<LoadCase>,
    /// The drives of the joints, tip first.
    pub drives: Vec<JointSizingRow>,
    /// Row of the design in `front.csv`: column names and cells.
    pub row: Vec<(String, String)>,
}

/// The results of an arm in one case, with the lines to draw.
struct Solved<'a> {
    case: &'a LoadCase,
    tip_mm: f64,
    parts: Vec<DeflectionPart>,
    lines: Vec<Station>,
    modes: Vec<(Mode, Vec<Station>)>,
    payload_m: Vector3<f64>,
}

/// The part of the tip deflection that one element causes.
#[derive(Debug, Clone, PartialEq)]
pub struct DeflectionPart {
    /// Name of the joint, bearing or link.
    pub element: String,
    /// Torque on the joint \[N m\]; `None` for other elements.
    pub torque_nm: Option<f64>,
    /// Force on the prismatic joint along its travel \[N\]; `None` for other elements.
    pub force_n: Option<f64>,
    /// Displacement of the tip by this element's deformation, world axes \[mm\].
    pub moved_mm: [f64; 3],
    /// Component of `moved_mm` along the whole tip deflection \[mm\].
    pub along_mm: f64,
}

impl PickedArm {
    /// The names of the pick, joined: `lightest, knee`.
    pub fn title(&self) -> String {
        self.pick.names.join(", ")
    }

    /// The first name of the pick, in the form in which it is a part of file names.
    fn slug(&self) -> String {
        file_name(self.pick.names[0])
    }

    /// Results of the arm in the case with the largest tip deflection; `None` without cases.
    fn worst(&self) -> Option<Solved<'_>> {
        let solved = self.cases.iter().map(|case| solve(&self.arm, case));
        solved.max_by(|a, b| a.tip_mm.total_cmp(&b.tip_mm))
    }

    /// Results of the arm in the case with the smallest lowest mode; `None` without cases.
    fn slowest(&self) -> Option<Solved<'_>> {
        let first = |s: &Solved| s.modes.first().map_or(f64::INFINITY, |m| m.0.frequency_hz);
        self.cases.iter().map(|case| solve(&self.arm, case)).min_by(|a, b| first(a).total_cmp(&first(b)))
    }

    /// The part of the tip deflection that each element causes, in the case with the largest tip deflection.
    pub fn deflection_parts(&self) -> Vec<DeflectionPart> {
        self.worst().map_or(Vec::new(), |s| s.parts)
    }

    /// The values for the template of the card that shows this pick. Pictures are added to `gallery`.
    pub(super) fn context(&self, gallery: &mut Gallery) -> Value {
        let (worst, slowest) = (self.worst(), self.slowest());
        let kinds = self.checks_of_any_drive();
        let drawing = worst.as_ref().map(|s| gallery.show(&self.drawing(s)));
        let modes: Vec<Value> =
            slowest.iter().flat_map(|s| self.mode_figures(s)).map(|figure| gallery.show(&figure)).collect();
        json!({
            "title": self.title(),
            "id": self.pick.design.design_id,
            "slug": self.slug(),
            "headline": super::front_views::headline(&self.pick.design),
            "cost": self.pick.design.material_cost_eur.map(cost_words),
            "drawing": drawing,
            "modes": modes,
            "worst_case": worst.as_ref().map(|s| s.case.name.clone()),
            "modal_case": slowest.as_ref().map(|s| s.case.name.clone()),
            "parts": worst.as_ref().map(|s| table(&parts_table(&s.parts))),
            "links": self.links(),
            "checks": kinds.iter().map(|kind| json!({"name": kind.label(), "unit": kind.unit()})).collect::<Vec<_>>(),
            "drives": self.drives.iter().rev().map(|row| drive(row, &kinds)).collect::<Vec<_>>(),
            "row": self.row,
        })
    }

    /// The kinds of checks that the page shows and that were made for some drive, in the order of its table. Drives
    /// differ in their checks: a screw has no bearing that tilts, and a rack does not buckle.
    fn checks_of_any_drive(&self) -> Vec<CheckKind> {
        let is_made =
            |kind: &CheckKind| self.drives.iter().any(|row| row.checks.iter().any(|c| c.kind == *kind));
        CHECKS.into_iter().filter(is_made).collect()
    }

    fn drawing(&self, solved: &Solved) -> Figure {
        let view = View::from_the_side(&solved.lines);
        let mut sketch = self.sketch(solved, &solved.lines, &view);
        sketch.factor = sketch.fitting_factor();
        let factor = shortest(sketch.factor);
        sketch.title = format!("{} in its worst pose: {}", self.title(), solved.case.name);
        sketch.caption = format!(
            "links to scale, joints as symbols; bent shape (outlined) exaggerated {factor} times: {} mm at the tip",
            significant(solved.tip_mm, 4)
        );
        sketch.description = format!(
            "{} Pose {}. Grey: without weight. Blue: bent by gravity and load, {factor} times exaggerated.",
            view.words,
            pose_signs(&self.arm.driven_joints(), &solved.case.pose_deg)
        );
        sketch.width_px = 620.0;
        let caption = format!(
            "{} Pose {}, payload {} kg (square).",
            view.words,
            pose_signs(&self.arm.driven_joints(), &solved.case.pose_deg),
            shortest(solved.case.payload.mass_kg)
        );
        Figure {
            name: format!("pick-{}-arm", self.slug()),
            caption,
            svg: sketch.to_svg(),
            csv: stations_csv(&solved.lines),
        }
    }

    fn mode_figures(&self, solved: &Solved) -> Vec<Figure> {
        let figure = |(i, (mode, line)): (usize, &(Mode, Vec<Station>))| {
            let view = View::of(line, &solved.lines);
            let mut sketch = self.sketch(solved, line, &view);
            sketch.factor = sketch.fitting_factor();
            sketch.title = format!("mode {}: {} Hz", i + 1, significant(mode.frequency_hz, 4));
            sketch.caption = energy_words(mode, 3);
            sketch.description = format!("{} Shape of mode {}, amplitude arbitrary.", view.words, i + 1);
            sketch.width_px = 400.0;
            Figure {
                name: format!("pick-{}-mode-{}", self.slug(), i + 1),
                caption: format!("{} Strain energy: {}.", view.words, energy_words(mode, 6)),
                svg: sketch.to_svg(),
                csv: stations_csv(line),
            }
        };
        solved.modes.iter().enumerate().map(figure).collect()
    }

    /// A drawing of the arm in the plane of a view. `line` has the points of its centre line with their displacements.
    fn sketch(&self, solved: &Solved, line: &[Station], view: &View) -> ArmSketch {
        let links: Vec<&Link> = self.arm.links().collect();
        let own = |name: &str| -> Vec<(Place, Place)> {
            let stations = line.iter().filter(|s| s.axis.is_none() && s.piece == name);
            stations.map(|s| (view.place(&s.at_m), view.place(&s.moved_m))).collect()
        };
        let tubes = links.iter().map(|link| Tube {
            name: link.name.clone(),
            line: own(&link.name),
            size_m: match &link.body {
                LinkBody::Tube { section, .. } if view.upright => section.outer_m().1,
                LinkBody::Tube { section, .. } => section.outer_m().0,
                LinkBody::Offset { .. } => 0.0,
            },
        });
        let ways = self.arm.prismatics().map(|joint| Tube {
            name: joint.name.clone(),
            line: own(&joint.name),
            size_m: 0.0,
        });
        let pivots = line.iter().filter_map(|s| {
            let axis = s.axis?;
            let across = axis.dot(&view.across()).abs() > 0.7;
            Some(Pivot {
                name: s.piece.clone(),
                at: (view.place(&s.at_m), view.place(&s.moved_m)),
                axis: (!across).then(|| view.place(&axis)),
                slides: false,
            })
        });
        // a joint that slides is drawn at the end of its travel
        let slides = self.arm.prismatics().filter_map(|joint| {
            let at = own(&joint.name).last().copied()?;
            Some(Pivot { name: joint.name.clone(), at, axis: None, slides: true })
        });
        let tip = line.last().map(|s| (view.place(&s.at_m), view.place(&s.moved_m)));
        ArmSketch {
            tubes: ways.chain(tubes).collect(),
            pivots: pivots.chain(slides).collect(),
            payload: (solved.case.payload.mass_kg > 0.0)
                .then(|| (view.place(&solved.payload_m), tip.map_or((0.0, 0.0), |(_, moved)| moved))),
            tip,
            springs: self.springs(solved.case, view),
            upright: view.upright,
            ..ArmSketch::default()
        }
    }

    /// End points of those balance springs that act along a line between two points, in the plane of a view.
    fn springs(&self, case: &LoadCase, view: &View) -> Vec<(Place, Place)> {
        let chain = Chain::new(&self.arm.structure_in(case), case.links);
        let ends = |(_, drawn): (String, Drawn)| match drawn {
            Drawn::Line { ends_m: [a, b], .. } => Some((view.place(&a), view.place(&b))),
            Drawn::Torsion { .. } => None,
        };
        springs_in(&chain, case).into_iter().filter_map(ends).collect()
    }

    /// Links with their sections, areas and second moments (Eqs 5, 6), as JSON.
    fn links(&self) -> Vec<Value> {
        let element = |e: &Element| match e {
            Element::Link(link) => match &link.body {
                LinkBody::Tube { material_name, material, section } => {
                    let p = section.properties(material.poisson);
                    Some(json!({
                        "name": link.name,
                        "material": without_factors(material_name),
                        "factors": material_name.strip_prefix(without_factors(material_name)),
                        "length_m": significant(link.vector_m.norm(), 3),
                        "size": section_size(section),
                        "mass_kg": significant(e.mass_kg(), 4),
                        "area_cm2": significant(p.area_m2 * 1e4, 4),
                        "second_moment_cm4": significant(p.second_moment_y_m4 * 1e8, 4),
                        "bending_knm2": significant(material.youngs_modulus_pa * p.second_moment_y_m4 / 1e3, 4),
                    }))
                }
                LinkBody::Offset { .. } => None,
            },
            Element::Joint(_) | Element::Prismatic(_) => None,
        };
        self.arm.chain.iter().filter_map(element).collect()
    }
}

/// A picture of the elements that cause the tip deflection, for several picks side by side.
pub(crate) fn deflection_bars(picks: &[PickedArm]) -> Figure {
    let parts: Vec<(String, Vec<DeflectionPart>)> = picks
        .iter()
        .map(|p| (format!("{} ({})", p.title(), p.pick.design.design_id), p.deflection_parts()))
        .collect();
    let is_link = |name: &str| picks.iter().any(|p| p.arm.links().any(|link| link.name == name));
    let first: &[DeflectionPart] = parts.first().map_or(&[], |(_, list)| list);
    let bars = StackedBars {
        title: "Where the tip's deflection comes from".into(),
        description: "One bar a picked design: its tip deflection in its worst pose, split into what each joint, bearing and guide \
                      (solid, blue) and each link (hatched, orange) adds along its direction."
            .into(),
        unit: "mm".into(),
        parts: first.iter().map(|p| Part { name: p.element.clone(), hatched: is_link(&p.element) }).collect(),
        bars: parts
            .iter()
            .map(|(label, list)| Bar {
                label: label.clone(),
                total: format!("{} mm", significant(list.iter().map(|p| p.along_mm).sum(), 4)),
                values: first
                    .iter()
                    .map(|f| list.iter().find(|p| p.element == f.element).map_or(0.0, |p| p.along_mm))
                    .collect(),
            })
            .collect(),
    };
    let caption = "Links are hatched; joints, their bearings and guides, and the base are solid. Each part is the motion of the tip by the element's deformation (Eqs 13 to 15), \
                   along the direction of the whole deflection, in the design's worst pose.";
    let csv = bars.to_csv();
    Figure { name: "deflection".into(), caption: caption.into(), svg: bars.readable().to_svg(), csv }
}

fn solve<'a>(arm: &Arm, case: &'a LoadCase) -> Solved<'a> {
    let structure = arm.structure_in(case);
    let chain = Chain::new(&structure, case.links);
    let posed = chain.pose(case);
    let statics = posed.statics();
    let pose_rad = chain.pose_si(&case.pose_deg);
    let modes = posed.modes(&statics, MODES_DRAWN);
    Solved {
        case,
        tip_mm: statics.tip_displacement_m.norm() * 1e3,
        parts: deflection_parts(&statics),
        lines: posed.centre_line(&pose_rad, &statics.deformations),
        modes: modes.into_iter().map(|m| (m.clone(), posed.centre_line(&pose_rad, &m.coordinates))).collect(),
        payload_m: payload_place(&posed, case),
    }
}

fn payload_place(posed: &Posed, case: &LoadCase) -> Vector3<f64> {
    posed.tip_m + posed.tip_rotation * case.payload.cg_m
}

fn deflection_parts(statics: &Statics) -> Vec<DeflectionPart> {
    let whole = statics.tip_displacement_m;
    let direction = if whole.norm() > 0.0 { whole.normalize() } else { Vector3::zeros() };
    let shares = statics.shares_m.iter();
    shares
        .map(|(element, moved)| DeflectionPart {
            element: element.clone(),
            torque_nm: statics.joint_torques_nm.iter().find(|(n, _)| n == element).map(|(_, t)| *t),
            force_n: statics.joint_forces_n.iter().find(|(n, _)| n == element).map(|(_, f)| *f),
            moved_mm: (moved * 1e3).into(),
            along_mm: moved.dot(&direction) * 1e3,
        })
        .collect()
}

fn parts_table(parts: &[DeflectionPart]) -> Table {
    let mut table = Table::new(vec![
        Column::left("element"),
        Column::unit("torque (7) in this pose", "N m"),
        Column::unit("x", "mm"),
        Column::unit("y", "mm"),
        Column::unit("z", "mm"),
        Column::unit("along the whole (13-15)", "mm"),
        Column::right("share"),
    ]);
    let whole: f64 = parts.iter().map(|p| p.along_mm).sum();
    for part in parts {
        let mm = |v: f64| fixed(v, 4);
        let [x, y, z] = part.moved_mm.map(mm);
        let force = part.force_n.map_or(String::new(), |n| format!("{} N", significant(n, 4)));
        let torque = part.torque_nm.map_or(force, |t| significant(t, 4));
        let share = percent(100.0 * part.along_mm / whole, 1);
        table.row([part.element.clone(), torque, x, y, z, mm(part.along_mm), share]);
    }
    table
}

/// The elements that have most of the strain energy of a mode, in words. At most `most` elements are named.
fn energy_words(mode: &Mode, most: usize) -> String {
    let mut parts: Vec<&(String, f64)> = mode.strain_energy.iter().filter(|(_, e)| *e >= 0.01).collect();
    parts.sort_by(|a, b| b.1.total_cmp(&a.1));
    let words: Vec<String> =
        parts.iter().take(most).map(|(n, e)| format!("{n} {}", percent(100.0 * e, 0))).collect();
    words.join(", ")
}

fn stations_csv(line: &[Station]) -> String {
    let mut out = String::from("piece,x_m,y_m,z_m,moved_x_m,moved_y_m,moved_z_m\n");
    for s in line {
        let numbers: Vec<String> = s.at_m.iter().chain(s.moved_m.iter()).map(|v| shortest(*v)).collect();
        out.push_str(&format!("{},{}\n", s.piece, numbers.join(",")));
    }
    out
}

/// The plane of a drawing. `right` and `up` are its axes; `upright` is false for a view from above.
struct View {
    right: Vector3<f64>,
    up: Vector3<f64>,
    upright: bool,
    words: &'static str,
}

impl View {
    /// The vertical plane through base and tip. `arm` has the points of the centre line.
    fn from_the_side(arm: &[Station]) -> Self {
        let tip = arm.last().map_or(Vector3::zeros(), |s| s.at_m);
        let level = Vector3::new(tip.x, tip.y, 0.0);
        let right = if level.norm() > 1e-6 { level.normalize() } else { Vector3::x() };
        Self { right, up: Vector3::z(), upright: true, words: "Seen from the side." }
    }

    /// The view from the side or, if the points `moving` move mostly out of its plane, from above.
    fn of(moving: &[Station], arm: &[Station]) -> Self {
        let side = Self::from_the_side(arm);
        let most =
            |of: &dyn Fn(&Vector3<f64>) -> f64| moving.iter().map(|s| of(&s.moved_m)).fold(0.0, f64::max);
        let sideways = most(&|m| m.dot(&side.across()).abs());
        if sideways < SIDEWAYS_SHARE * most(&|m| m.norm()) {
            return side;
        }
        let up = Vector3::z().cross(&side.right);
        Self { right: side.right, up, upright: false, words: "Seen from above." }
    }

    fn across(&self) -> Vector3<f64> {
        self.right.cross(&self.up)
    }

    fn place(&self, at: &Vector3<f64>) -> Place {
        (at.dot(&self.right), at.dot(&self.up))
    }
}

/// The checks that the page shows, in the order of its table.
const CHECKS: [CheckKind; 23] = [
    CheckKind::GearPeak,
    CheckKind::GearMean,
    CheckKind::GearStop,
    CheckKind::GearBuckling,
    CheckKind::GearRatcheting,
    CheckKind::BearingMoment,
    CheckKind::BearingRest,
    CheckKind::BearingStop,
    CheckKind::BearingLife,
    CheckKind::GearSpeed,
    CheckKind::GearMeanSpeed,
    CheckKind::GearLife,
    CheckKind::GearStops,
    CheckKind::MotorHold,
    CheckKind::MotorPeak,
    CheckKind::MotorRms,
    CheckKind::MotorSpeed,
    CheckKind::GearWidth,
    CheckKind::MotorWidth,
    CheckKind::MotorLength,
    CheckKind::GearBore,
    CheckKind::MotorBore,
    CheckKind::DriveLength,
];

/// The sizing of one joint for the template: torques, parts and the margin of every check. The columns of the page have
/// the units of joints that turn, so the forces of a joint that slides are written with their own unit. There is one
/// entry for each of the checks `kinds`, null where the drive does not have this check.
fn drive(row: &JointSizingRow, kinds: &[CheckKind]) -> Value {
    let number = |v: f64| significant(v, 4);
    let open = |v: Option<f64>| v.map_or("unknown".to_string(), number);
    let load = |v: Option<f64>| match v {
        Some(force_n) if row.slides => format!("{} N", number(force_n)),
        _ => open(v),
    };
    let of_kind = |kind: &CheckKind| row.checks.iter().find(|c| c.kind == *kind);
    let made: Vec<Value> =
        kinds.iter().map(|kind| of_kind(kind).map_or(Value::Null, |c| check(c, row.binds))).collect();
    json!({
        "joint": row.joint,
        "gear": row.gear,
        "motor": row.motor,
        "static": load(Some(row.static_torque_nm)),
        "linear": load(Some(row.linear_torque_nm)),
        "rotary": load(row.rotary_torque_output_nm),
        "total": load(row.total_torque_nm),
        "motor_rpm": format!("{:.0}", row.motor_speed_rpm),
        "mass_kg": open(row.mass_kg),
        "inward_kg": number(row.mass_passed_inward_kg),
        "binds": row.binds,
        "margin": row.margin.map(|m| significant(m, 3)),
        "checks": made,
    })
}

fn check(check: &Check, binds: Option<&str>) -> Value {
    let number = |v: Option<f64>| v.filter(|v| v.is_finite()).map(|v| significant(v, 4));
    let margin = check.torque_margin().filter(|m| m.is_finite());
    json!({
        "name": check.kind.label(),
        "unit": check.kind.unit(),
        "own_unit": (check.unit() != check.kind.unit()).then(|| check.unit()),
        "needed": number(check.needed),
        "allowed": number(check.allowed),
        "margin": margin.map(|m| if m < 100.0 { significant(m, 3) } else { "> 100".into() }),
        "binds": binds == Some(check.kind.label()),
        "open": matches!(check.state, CheckState::NotChecked(_)),
        "fails": check.state == CheckState::Fails,
    })
}
