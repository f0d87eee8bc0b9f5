//! A small plot writer: one self-contained SVG, legible in colour, in greyscale and by a screen reader.
//!
//! Series differ by colour (the palette of Okabe and Ito, for colour-blind readers) *and* by marker shape; `open`
//! markers and dashed lines mark variants of the same thing. The legend is outside the frame, so that it never covers
//! data. Notes are moved until they are inside the frame. The file has only the two coordinates of each point, so that
//! the picture of thousands of points stays small.
//!
//! ```
//! use armwright::report::svg::{Axis, Plot, Scale, Series};
//! let plot = Plot {
//!     title: "Deflection of a beam".into(),
//!     description: "Deflection falls as the section grows.".into(),
//!     x: Axis::new("outer size [mm]", Scale::Linear),
//!     y: Axis::new("deflection [mm]", Scale::Log),
//!     series: vec![Series::line("steel", 0, vec![(70.0, 0.305), (160.0, 0.023)])],
//!     ..Plot::default()
//! };
//! assert!(plot.to_svg().starts_with("<svg"));
//! ```

pub(crate) mod arm;
pub(crate) mod bars;
pub(crate) mod draw;
pub(crate) mod marker;
pub(crate) mod parallel;
pub(crate) mod plot;
pub(crate) mod rows;
pub(crate) mod scale;
pub(crate) mod sheet;
pub(crate) mod ticks;

pub use draw::{MUTED, PALETTE};
pub use plot::{Axis, Guide, Note, Plot, Series, Side, Stroke};
pub use scale::Scale;
pub use sheet::Sheet;
