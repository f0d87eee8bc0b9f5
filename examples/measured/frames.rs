//! Turns a table of Denavit-Hartenberg frames into a chain of joints and links, with the axes and positions at zero
//! angles.

use nalgebra::{Matrix4, Rotation3, Translation3, Unit, Vector3};
use serde_json::{Value, json};

/// The frame that has been reached on the way along the chain, and the elements of the chain so far.
pub struct Walk {
    frame: Matrix4<f64>,
    /// Position in the world at which the elements so far end \[m\].
    written_m: Vector3<f64>,
    /// Joints and links so far, as in an arm file.
    pub chain: Vec<Value>,
}

impl Walk {
    /// A walk that begins at the base, without any elements.
    pub fn new() -> Self {
        Self { frame: Matrix4::identity(), written_m: Vector3::zeros(), chain: Vec::new() }
    }

    /// Turns the frame about its x axis.
    pub fn turn_x(&mut self, angle_deg: f64) {
        self.turn(Vector3::x_axis(), angle_deg);
    }

    /// Turns the frame about its z axis.
    pub fn turn_z(&mut self, angle_deg: f64) {
        self.turn(Vector3::z_axis(), angle_deg);
    }

    fn turn(&mut self, axis: Unit<Vector3<f64>>, angle_deg: f64) {
        self.frame *= Rotation3::from_axis_angle(&axis, angle_deg.to_radians()).to_homogeneous();
    }

    /// Moves the frame along its own axes \[m\].
    pub fn shift(&mut self, x: f64, y: f64, z: f64) {
        self.frame *= Translation3::new(x, y, z).to_homogeneous();
    }

    fn at_m(&self) -> Vector3<f64> {
        self.frame.fixed_view::<3, 1>(0, 3).into_owned()
    }

    /// Adds a joint about the z axis of the frame. `coupled` has the driving joints and their factors if the joint is
    /// passive; `None` for a driven joint.
    pub fn joint(&mut self, name: &str, coupled: Option<Value>) {
        let axis = self.frame.fixed_view::<3, 1>(0, 2).into_owned();
        let mut joint =
            json!({"type": "joint", "name": name, "axis": axis.as_slice(), "stiffness_nm_per_rad": null});
        if let Some(terms) = coupled {
            joint["coupled"] = terms;
        }
        self.chain.push(joint);
    }

    /// Adds a link from the end of the last element to the origin of the frame, with a point mass in its middle.
    pub fn link(&mut self, name: &str, mass_kg: f64) {
        let vector = self.at_m() - self.written_m;
        self.push_link(name, vector, mass_kg);
    }

    /// Adds a point mass at the position `cg_m` \[m\] in the frame. It becomes a link that has this mass in its middle.
    /// The elements so far then end beyond the mass.
    pub fn mass(&mut self, name: &str, mass_kg: f64, cg_m: [f64; 3]) {
        let cg = (self.frame * Vector3::from(cg_m).push(1.0)).fixed_rows::<3>(0).into_owned();
        self.push_link(name, 2.0 * (cg - self.written_m), mass_kg);
    }

    fn push_link(&mut self, name: &str, vector: Vector3<f64>, mass_kg: f64) {
        self.chain
            .push(json!({"type": "link", "name": name, "vector_m": vector.as_slice(), "mass_kg": mass_kg}));
        self.written_m += vector;
    }
}
