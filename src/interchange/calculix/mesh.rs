//! Finite-element meshes of straight links: quadratic bricks with reduced integration (C3D20R), regular along the
//! link.
//!
//! A rectangular or I section is divided by lines along its walls; each rectangle of material between the lines is
//! divided further. A round section is a ring of bricks, with one brick through the wall. A round bar gets a bore of
//! a hundredth of its diameter, because regular bricks cannot fill its axis; this removes 1e-4 of its area.

use crate::arm::section::Section;
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Number of bricks around a round section.
const ROUND: usize = 16;
/// Number of bricks along a side between two walls, and across a solid bar.
const SIDE: usize = 4;
/// Smallest and largest number of bricks along a link.
const ALONG: (usize, usize) = (8, 24);
/// Diameter of the bore of a round bar, as a fraction of the bar's diameter.
const BORE: f64 = 0.01;

/// Positions of the 20 nodes of a brick, in half bricks along three local directions.
const BRICK: [(usize, usize, usize); 20] = [
    (0, 0, 0),
    (2, 0, 0),
    (2, 2, 0),
    (0, 2, 0),
    (0, 0, 2),
    (2, 0, 2),
    (2, 2, 2),
    (0, 2, 2),
    (1, 0, 0),
    (2, 1, 0),
    (1, 2, 0),
    (0, 1, 0),
    (1, 0, 2),
    (2, 1, 2),
    (1, 2, 2),
    (0, 1, 2),
    (0, 0, 1),
    (2, 0, 1),
    (2, 2, 1),
    (0, 2, 1),
];

/// The mesh of a link.
#[derive(Debug, Clone, Default)]
pub(crate) struct Mesh {
    /// Positions of the nodes in the world \[m\].
    pub nodes_m: Vec<Vector3<f64>>,
    /// Indices of the 20 nodes of each brick.
    pub bricks: Vec<[usize; 20]>,
    /// Indices of the nodes in each cross-section between bricks, from root to end. The first and the last are the
    /// end faces.
    pub stations: Vec<Vec<usize>>,
}

/// The mesh of a cross-section: a grid in two local directions, the first of which may be closed to a ring.
struct Grid {
    /// Number of bricks in each direction.
    bricks: (usize, usize),
    /// Whether the grid's first direction runs around the section, as in a round tube.
    closes: bool,
    /// Whether the brick with these indices has material.
    has: Box<dyn Fn(usize, usize) -> bool>,
    /// Position of the node with these indices (counted in half bricks), along y and z of the section \[m\].
    place: Box<dyn Fn(usize, usize) -> (f64, f64)>,
}

/// Whether a section can be meshed. A section with stated stiffnesses cannot, because it has no known shape.
pub(crate) fn has_shape(section: &Section) -> bool {
    !matches!(section, Section::Stated(_))
}

/// The mesh of a link that starts at `root_m` and has the length `length_m` along the first column of `frame`. `None`
/// if the section has no known shape.
pub(crate) fn mesh(
    section: &Section,
    root_m: &Vector3<f64>,
    frame: &Matrix3<f64>,
    length_m: f64,
) -> Option<Mesh> {
    let grid = grid(section)?;
    let (width_m, height_m) = section.outer_m();
    let along =
        (2.0 * length_m / width_m.max(height_m)).ceil().clamp(ALONG.0 as f64, ALONG.1 as f64) as usize;
    let mut out = Mesh { stations: vec![Vec::new(); along + 1], ..Mesh::default() };
    let mut numbers: BTreeMap<(usize, usize, usize), usize> = BTreeMap::new();
    let (across, through) = grid.bricks;
    for i in 0..along {
        for (j, k) in (0..across).flat_map(|j| (0..through).map(move |k| (j, k))) {
            if !(grid.has)(j, k) {
                continue;
            }
            let brick = BRICK.map(|(a, b, c)| {
                let round = if grid.closes { (2 * j + b) % (2 * across) } else { 2 * j + b };
                let at = (2 * i + a, round, 2 * k + c);
                *numbers.entry(at).or_insert_with(|| {
                    let (y, z) = (grid.place)(at.1, at.2);
                    let x = length_m * at.0 as f64 / (2 * along) as f64;
                    out.nodes_m.push(root_m + frame * Vector3::new(x, y, z));
                    out.nodes_m.len() - 1
                })
            });
            out.bricks.push(brick);
        }
    }
    for ((i, _, _), node) in numbers {
        if i % 2 == 0 {
            out.stations[i / 2].push(node);
        }
    }
    Some(out)
}

fn grid(section: &Section) -> Option<Grid> {
    Some(match *section {
        Section::RectangularTube { width_m, height_m, wall_m } => {
            let (y, z) = (walls(width_m, wall_m), walls(height_m, wall_m));
            cells(y, z, |row, column| row != 1 || column != 1)
        }
        Section::RectangularBar { width_m, height_m } => {
            let half = |m: f64| vec![-m / 2.0, m / 2.0];
            cells(half(width_m), half(height_m), |_, _| true)
        }
        Section::IBeam { width_m, height_m, web_m, flange_m } => {
            let y = vec![-width_m / 2.0, -web_m / 2.0, web_m / 2.0, width_m / 2.0];
            cells(y, walls(height_m, flange_m), |column, row| row != 1 || column == 1)
        }
        Section::RoundTube { diameter_m, wall_m } => ring(diameter_m, wall_m),
        Section::RoundBar { diameter_m } => ring(diameter_m, diameter_m * (1.0 - BORE) / 2.0),
        Section::Stated(_) => return None,
    })
}

/// Coordinates across a tube of the outer and inner faces of two opposite walls, in ascending order \[m\].
fn walls(outer_m: f64, wall_m: f64) -> Vec<f64> {
    vec![-outer_m / 2.0, wall_m - outer_m / 2.0, outer_m / 2.0 - wall_m, outer_m / 2.0]
}

/// A grid of the rectangles between lines at `y_m` and `z_m` \[m\]. `has` says which rectangles have material.
/// Rectangles between walls are divided further.
fn cells(y_m: Vec<f64>, z_m: Vec<f64>, has: impl Fn(usize, usize) -> bool + 'static) -> Grid {
    let cut = |lines: &[f64]| {
        let rectangles = lines.len() - 1;
        // a wall has a single brick through its thickness
        let counts: Vec<usize> =
            (0..rectangles).map(|r| if rectangles == 1 || r == 1 { SIDE } else { 1 }).collect();
        let owners: Vec<usize> = counts.iter().enumerate().flat_map(|(r, n)| vec![r; *n]).collect();
        let mut ends = vec![lines[0]];
        for (r, n) in counts.iter().enumerate() {
            let step = (lines[r + 1] - lines[r]) / *n as f64;
            ends.extend((1..=*n).map(|i| lines[r] + step * i as f64));
        }
        (owners, ends)
    };
    let ((of_y, y_m), (of_z, z_m)) = (cut(&y_m), cut(&z_m));
    let half = |ends: &[f64], at: usize| (ends[at / 2] + ends[at.div_ceil(2)]) / 2.0;
    Grid {
        bricks: (of_y.len(), of_z.len()),
        closes: false,
        has: Box::new(move |j, k| has(of_y[j], of_z[k])),
        place: Box::new(move |j, k| (half(&y_m, j), half(&z_m, k))),
    }
}

/// A grid around a round tube. The first direction goes around the tube, the second from the outside to the inside.
fn ring(diameter_m: f64, wall_m: f64) -> Grid {
    Grid {
        bricks: (ROUND, 1),
        closes: true,
        has: Box::new(|_, _| true),
        place: Box::new(move |j, k| {
            let radius_m = diameter_m / 2.0 - wall_m * k as f64 / 2.0;
            let angle_rad = TAU * j as f64 / (2 * ROUND) as f64;
            (radius_m * libm::cos(angle_rad), radius_m * libm::sin(angle_rad))
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Volume of a brick from its Jacobian at eight Gauss points, with the shape functions of its eight vertices. It
    /// is exact for bricks with straight edges, so rectangular sections are compared up to rounding.
    fn volume_m3(mesh: &Mesh) -> f64 {
        let g = 1.0 / 3f64.sqrt();
        let corner = |n: usize| {
            [
                (-1.0, -1.0, -1.0),
                (1.0, -1.0, -1.0),
                (1.0, 1.0, -1.0),
                (-1.0, 1.0, -1.0),
                (-1.0, -1.0, 1.0),
                (1.0, -1.0, 1.0),
                (1.0, 1.0, 1.0),
                (-1.0, 1.0, 1.0),
            ][n]
        };
        let mut volume = 0.0;
        for brick in &mesh.bricks {
            for (x, y, z) in (0..8).map(corner).map(|(a, b, c)| (a * g, b * g, c * g)) {
                let mut jacobian = Matrix3::zeros();
                for (n, node) in brick.iter().enumerate().take(8) {
                    let (a, b, c) = corner(n);
                    let slopes = Vector3::new(
                        a * (1.0 + b * y) * (1.0 + c * z),
                        b * (1.0 + a * x) * (1.0 + c * z),
                        c * (1.0 + a * x) * (1.0 + b * y),
                    ) / 8.0;
                    jacobian += mesh.nodes_m[*node] * slopes.transpose();
                }
                volume += jacobian.determinant();
            }
        }
        volume
    }

    #[test]
    fn bricks_fill_the_section_and_none_is_inside_out() {
        let frame = Matrix3::identity();
        let sections = [
            Section::RectangularTube { width_m: 0.1, height_m: 0.16, wall_m: 0.01 },
            Section::RectangularBar { width_m: 0.05, height_m: 0.08 },
            Section::IBeam { width_m: 0.1, height_m: 0.2, web_m: 0.006, flange_m: 0.01 },
        ];
        for section in sections {
            let mesh = mesh(&section, &Vector3::zeros(), &frame, 0.8).expect("a shape");
            let exact = section.properties(0.3).area_m2 * 0.8;
            assert!((volume_m3(&mesh) / exact - 1.0).abs() < 1e-12, "{section:?}");
        }
        // straight edges between 16 vertices: the area is that of a polygon, sin(2π/16)/(2π/16) of that of the circle
        let section = Section::RoundTube { diameter_m: 0.1, wall_m: 0.01 };
        let mesh = mesh(&section, &Vector3::zeros(), &frame, 0.8).expect("a shape");
        let step = TAU / ROUND as f64;
        let exact = section.properties(0.3).area_m2 * 0.8 * step.sin() / step;
        assert!((volume_m3(&mesh) / exact - 1.0).abs() < 1e-12);
        assert!(super::mesh(&Section::Stated(stated()), &Vector3::zeros(), &frame, 1.0).is_none());
    }

    fn stated() -> crate::arm::StatedSection {
        crate::arm::StatedSection {
            width_m: 0.1,
            height_m: 0.1,
            ei_y_nm2: 1e4,
            ei_z_nm2: 1e4,
            gj_nm2: 1e4,
            ea_n: f64::INFINITY,
            kg_per_m: 2.0,
        }
    }
}
