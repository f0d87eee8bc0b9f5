//! Laws of a base, of bearings and of links: they may be more compliant in one direction or in one part only, and links
//! may have another mass or wall than drawn.

use super::{Builder, Law, placed};
use crate::arm::BASE;
use crate::mechanics::beam::Strain;
use crate::reconcile::fit::descent::change_to;
use crate::reconcile::forward::coefficients::Coefficients;

impl Builder<'_> {
    /// Laws of a base, of bearings and of links that are more compliant than modelled, each in one direction only or in
    /// one part of the link only.
    pub(super) fn compliance_laws(&self) -> Vec<Law> {
        let layout = &self.forward.layout;
        let own = &self.fit.point.coefficients;
        let joints: Vec<f64> = own.laws.iter().map(|law| law.tangent_compliance_rad_per_nm(0.0)).collect();
        let Some(common) = self.first_compliance_rad_per_nm() else { return Vec::new() };
        let law = |at: &str, what: String, further: &[(usize, f64)]| Law {
            at: Some(at.to_string()),
            ..Law::new(what, vec![self.compliance_column(further)])
        };
        let tilts = |at: &str, what: String, first: usize, compliance: f64| {
            [first, first + 1].map(|i| law(at, what.clone(), &[(i, compliance)]))
        };
        let mut out = Vec::from(tilts(BASE, "a base that tilts about one axis only".into(), 0, common));
        for (joint, compliance) in layout.joints.iter().zip(&joints) {
            let what = format!("a bearing of {} that tilts about one axis only", joint.name);
            let compliance = if *compliance > 0.0 { *compliance } else { common };
            out.extend(tilts(&joint.name, what, joint.twist - 2, compliance));
        }
        for link in &layout.links {
            let strained = |what: String, wanted: &dyn Fn(Strain, usize) -> bool| {
                let strains = link.strains.iter().enumerate().filter(|(_, (s, degree))| wanted(*s, *degree));
                let further = strains.map(|(i, _)| (link.first + i, own.linear[link.first + i]));
                law(&link.name, what, &further.collect::<Vec<_>>())
            };
            out.push(strained(format!("a torsion of {} beyond its own", link.name), &|s, _| {
                s == Strain::Twist
            }));
            for plane in [Strain::CurvatureZ, Strain::CurvatureY] {
                let name = &link.name;
                out.push(strained(format!("a bending of {name} in one plane only"), &|s, _| s == plane));
                let at_one_end = |s, degree| s == plane && degree == 1;
                out.push(strained(format!("a bending of {name} in a part of it"), &at_one_end));
            }
        }
        out
    }

    /// Laws of links that are lighter or heavier than drawn, and of tubes whose wall is thinner or thicker. A thinner
    /// wall lowers mass and stiffness in proportion.
    pub(super) fn link_laws(&self) -> Vec<Law> {
        let links = self.forward.nominal.structure.links().enumerate();
        let laws = links.filter(|(_, link)| link.tube_kg_per_m() > 0.0).flat_map(|(l, link)| {
            let lighter =
                move |c: &mut Coefficients, part: f64| self.lighten(c, l, part * link.tube_kg_per_m());
            let thinner = move |c: &mut Coefficients, part: f64| {
                lighter(c, part);
                let slot = &self.forward.layout.links[l];
                let own = slot.first..slot.first + slot.strains.len();
                c.linear[own].iter_mut().for_each(|compliance| *compliance *= 1.0 + part);
            };
            let law = |what: &str, changed: &dyn Fn(&mut Coefficients, f64)| {
                let what = format!("a {what} of {} other than drawn", link.name);
                Law::new(what, vec![self.changed_column(changed)])
            };
            placed(&link.name, vec![law("mass", &lighter), law("wall", &thinner)])
        });
        laws.collect()
    }

    /// Removes `kg_per_m` from the mass per length of the link with index `link` \[kg/m\], in mass and weight.
    fn lighten(&self, coefficients: &mut Coefficients, link: usize, kg_per_m: f64) {
        let index = self.forward.layout.joints.len() + link;
        coefficients.masses[index] -= kg_per_m;
        coefficients.weights[index] -= kg_per_m;
    }

    /// The derivative of every reading with respect to the size of a change of the coefficients, at size zero.
    /// `changed` applies the change of a given size to coefficients.
    fn changed_column(&self, changed: &dyn Fn(&mut Coefficients, f64)) -> Vec<f64> {
        const DERIVATIVE_STEP: f64 = 1e-4;
        let mut moved = self.fit.point.coefficients.clone();
        changed(&mut moved, DERIVATIVE_STEP);
        change_to(self.forward, &self.fit.point, moved).into_iter().map(|d| d / DERIVATIVE_STEP).collect()
    }

    /// The change of every reading, in its unit, by additional compliances. Each entry of `further` is a pair: index of
    /// the strain coordinate, and its additional compliance.
    pub(super) fn compliance_column(&self, further: &[(usize, f64)]) -> Vec<f64> {
        let forward = self.forward;
        let mut truth = vec![0.0; forward.data.len()];
        for pose in &forward.statics {
            pose.add_compliant(&forward.layout, &self.fit.point.coefficients, further, &mut truth);
        }
        self.add_modal(&mut truth, |_, _, y| further.iter().map(|(i, c)| y[*i].powi(2) * c).sum());
        self.read(&truth)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::about_the_nominal_arm;
    use crate::reconcile::model::calibration::Calibration;

    #[test]
    fn a_link_that_yields_more_in_every_way_has_a_lower_modulus() {
        about_the_nominal_arm(|builder, nuisance| {
            let (forward, fit) = (builder.forward, builder.fit);
            let linear = &fit.point.coefficients.linear;
            let of_links = forward.layout.links.iter().flat_map(|l| l.first..l.first + l.strains.len());
            let column = builder.compliance_column(&of_links.map(|i| (i, linear[i])).collect::<Vec<_>>());
            let is_modulus = |c: &Calibration| matches!(c, Calibration::Modulus(..));
            let p = nuisance.numbers.iter().position(|(c, _)| is_modulus(c)).expect("calibrated");
            let largest = fit.jacobian.column(p).amax() / nuisance.numbers[p].1;
            for (i, own) in column.iter().enumerate() {
                let softer = -fit.jacobian[(i, p)] / nuisance.numbers[p].1;
                assert!((own - softer).abs() <= 1e-3 * largest, "datum {i}: {own} and {softer}");
            }
        });
    }
}
