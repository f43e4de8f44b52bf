//! A pile of grains: its side view with the fitted flanks, and its slope by azimuth.

use plotters::{
    prelude::*,
    style::text_anchor::{HPos, VPos},
};

use super::Figure;
use crate::{
    geometry::Vector,
    measure,
    record::{AngleOfRepose, AzimuthAngle},
    report::{
        ReportError,
        axis::Axis,
        dash::dashes,
        plot::{Area, Failure, Look, Plot, font, whole},
        silhouette::{Facet, facets},
        style::{self, INK},
        table::{Table, row},
    },
    specimen::Specimen,
    units::to_mm,
};

/// Directions within so many degrees of right and left give the drawn lines.
const SIDE_DEGREES: f64 = 30.0;
/// Length of the scale bar in mm.
const SCALE_BAR_MM: f64 = 50.0;
/// Space in mm around what is drawn.
const MARGIN_MM: f64 = 12.0;
/// Height in mm of the floor as drawn: what is sunk into it does not show below.
const FLOOR_MM: f64 = 20.0;
/// Space in SVG units above the pile, for the angle, and below, for the scale.
const ABOVE: i32 = 150;
const BELOW: i32 = 170;
/// Colour of a face that looks to the light, in red, green and blue.
const GRAIN: [f64; 3] = [222.0, 212.0, 194.0];
const FIXED: [f64; 3] = [168.0, 174.0, 180.0];
/// Share of the light that a face turned away from it still has.
const SHADE: f64 = 0.42;

/// `pile` and `angle-by-azimuth`.
pub(in crate::report) fn of_pile(
    specimen: &Specimen,
    pile: &AngleOfRepose,
) -> Result<Vec<Figure>, ReportError> {
    Ok(vec![side_view(specimen, pile)?, by_azimuth(&[("".into(), pile)])?])
}

/// The mean of fitted lines.
struct Side {
    /// Positive where it falls outwards.
    slope: f64,
    /// Height in mm above the base at which it meets the axis.
    at_axis_mm: f64,
}

impl Side {
    /// Of the sectors near a direction; none where it does not fall outwards.
    fn of(pile: &AngleOfRepose, towards_degrees: f64) -> Option<Self> {
        let near = |a: &&AzimuthAngle| {
            let apart = (a.azimuth_degrees - towards_degrees + 540.0).rem_euclid(360.0) - 180.0;
            apart.abs() <= SIDE_DEGREES
        };
        let line = |a: &AzimuthAngle| {
            let slope = a.degrees?.to_radians().tan();
            Some((slope, slope * a.toe_radius_mm?))
        };
        let lines: Vec<(f64, f64)> = pile.by_azimuth.iter().filter(near).filter_map(line).collect();
        let mean =
            |of: fn(&(f64, f64)) -> f64| lines.iter().map(of).sum::<f64>() / lines.len() as f64;
        let (slope, at_axis_mm) = (mean(|l| l.0), mean(|l| l.1));
        (slope > 0.0).then_some(Self { slope, at_axis_mm })
    }

    fn degrees(&self) -> f64 {
        self.slope.atan().to_degrees()
    }

    fn toe_mm(&self) -> f64 {
        self.at_axis_mm / self.slope
    }
}

/// The pile seen along y, with the fitted flanks.
///
/// # Errors
/// [`ReportError::Figure`].
pub fn side_view(specimen: &Specimen, pile: &AngleOfRepose) -> Result<Figure, ReportError> {
    // Above z = 0: that on which the angle was measured.
    let base_level_mm = measure::base_level(specimen).map_or(0.0, to_mm);
    let mut svg = String::new();
    let drawn = Picture::new(specimen, pile, base_level_mm).draw(&mut svg);
    let mut table = Table::new(["side", "degrees", "toe_radius_mm", "axis_x_mm", "base_level_mm"]);
    for (name, towards) in [("right", 0.0), ("left", 180.0)] {
        if let Some(side) = Side::of(pile, towards) {
            let axis = pile.axis_mm[0];
            table.row(row![name, side.degrees(), side.toe_mm(), axis, base_level_mm]);
        }
    }
    let caption = format!(
        "The pile seen along y. The lines are the fitted flanks on either side, means over the \
         sectors within {SIDE_DEGREES}° of it, drawn solid where they are fitted. They \
         follow the mean surface of a sector; grains of the silhouette stand in front of it."
    );
    let svg = drawn.map(|()| svg).map_err(|e| e.to_string());
    Figure::of_svg("pile", "Side view of the pile", caption, svg, &table)
}

/// What the side view shows, and how millimetres become SVG units.
struct Picture<'a> {
    pile: &'a AngleOfRepose,
    base_level_mm: f64,
    facets: Vec<Facet>,
    left_mm: f64,
    top_mm: f64,
    scale: f64,
    height: i32,
}

impl<'a> Picture<'a> {
    fn new(specimen: &Specimen, pile: &'a AngleOfRepose, base_level_mm: f64) -> Self {
        let radius_mm = specimen.state.base.as_ref().map_or(0.0, |base| to_mm(base.radius));
        let top_mm = base_level_mm + pile.pile_height_mm + MARGIN_MM;
        let bottom_mm = -FLOOR_MM;
        let scale = f64::from(style::WIDTH) / (2.0 * (radius_mm + MARGIN_MM));
        Self {
            pile,
            base_level_mm,
            facets: facets(specimen),
            left_mm: -radius_mm - MARGIN_MM,
            top_mm,
            scale,
            height: ABOVE + ((top_mm - bottom_mm) * scale) as i32 + BELOW,
        }
    }

    fn at(&self, x_mm: f64, z_mm: f64) -> (f64, f64) {
        ((x_mm - self.left_mm) * self.scale, f64::from(ABOVE) + (self.top_mm - z_mm) * self.scale)
    }

    fn draw(&self, svg: &mut String) -> Result<(), Failure> {
        let size = (style::WIDTH, self.height as u32);
        let root = SVGBackend::with_string(svg, size).into_drawing_area();
        root.fill(&WHITE)?;
        for facet in &self.facets {
            self.facet(&root, facet)?;
        }
        // The floor hides what of the fixed grains is sunk into it.
        self.floor(&root)?;
        for towards in [0.0, 180.0] {
            self.flank(&root, towards)?;
        }
        self.angle(&root)?;
        self.scale_bar(&root)?;
        root.present()
    }

    fn floor(&self, root: &Area) -> Result<(), Failure> {
        let (left, right) = (self.left_mm, -self.left_mm);
        let (upper_left, lower_right) = (self.at(left, 0.0), self.at(right, -FLOOR_MM));
        root.draw(&Rectangle::new([whole(upper_left), whole(lower_right)], style::BAND.filled()))?;
        let surface = vec![whole(upper_left), whole(self.at(right, 0.0))];
        root.draw(&PathElement::new(surface, INK.stroke_width(style::THIN)))
    }

    fn facet(&self, root: &Area, facet: &Facet) -> Result<(), Failure> {
        let light = Vector::new(-0.45, -0.6, 0.66).normalize();
        let lit = SHADE + (1.0 - SHADE) * facet.normal.dot(&light).max(0.0);
        let ground = if facet.fixed { FIXED } else { GRAIN };
        let [r, g, b] = ground.map(|c| (c * lit).round() as u8);
        let corners: Vec<(i32, i32)> =
            facet.corners.iter().map(|c| whole(self.at(to_mm(c.0), to_mm(c.1)))).collect();
        root.draw(&Polygon::new(corners.clone(), RGBColor(r, g, b).filled()))?;
        let edge = ground.map(|c| (c * lit * 0.72).round() as u8);
        let closed: Vec<(i32, i32)> = corners.iter().chain(corners.first()).copied().collect();
        let line = RGBColor(edge[0], edge[1], edge[2]).stroke_width(1);
        root.draw(&PathElement::new(closed, line))
    }

    /// The fitted line of one side, with its angle beside it.
    fn flank(&self, root: &Area, towards: f64) -> Result<(), Failure> {
        let Some(line) = Side::of(self.pile, towards) else { return Ok(()) };
        let sign = if towards == 0.0 { 1.0 } else { -1.0 };
        let point = |r: f64| {
            let height = line.at_axis_mm - line.slope * r;
            self.at(self.pile.axis_mm[0] + sign * r, self.base_level_mm + height)
        };
        let colour = style::colour(1);
        let path = |from: f64, to: f64| [point(from), point(to)];
        for piece in dashes(&path(0.0, line.toe_mm()), style::DASHED) {
            let piece: Vec<(i32, i32)> = piece.into_iter().map(whole).collect();
            root.draw(&PathElement::new(piece, colour.stroke_width(4)))?;
        }
        let [inner, outer] = self.pile.flank_radii_mm;
        let fitted = path(inner, outer);
        let fitted: Vec<(i32, i32)> = fitted.into_iter().map(whole).collect();
        root.draw(&PathElement::new(fitted, colour.stroke_width(9)))?;
        let (x, y) = point(0.4 * line.toe_mm());
        let anchor = if sign > 0.0 { HPos::Left } else { HPos::Right };
        let at = (x as i32 + (sign * 110.0) as i32, y as i32 - 80);
        let text = format!("{:.1}°", line.degrees());
        root.draw(&Text::new(text, at, font(style::NAMES, (anchor, VPos::Center), UPRIGHT)))
    }

    fn angle(&self, root: &Area) -> Result<(), Failure> {
        let a = self.pile;
        let text = format!(
            "Angle of repose {:.1}°, mean of all directions (95 % of this pile: {:.1}° to {:.1}°)",
            a.degrees, a.confidence_low_degrees, a.confidence_high_degrees
        );
        let at = (style::WIDTH as i32 / 2, ABOVE / 2);
        root.draw(&Text::new(text, at, font(style::NUMBERS, CENTRE, UPRIGHT)))
    }

    fn scale_bar(&self, root: &Area) -> Result<(), Failure> {
        let y = self.height - BELOW / 2;
        let x = style::LEFT / 2;
        let end = x + (SCALE_BAR_MM * self.scale) as i32;
        root.draw(&Rectangle::new([(x, y), (end, y + 12)], INK.filled()))?;
        let at = (end + 30, y + 6);
        let text = format!("{SCALE_BAR_MM} mm");
        let style = font(style::NUMBERS, (HPos::Left, VPos::Center), UPRIGHT);
        root.draw(&Text::new(text, at, style))
    }
}

const UPRIGHT: FontTransform = FontTransform::None;
const CENTRE: (HPos, VPos) = (HPos::Center, VPos::Center);

/// The slope of each sector of piles, by name; one pile shows its mean and its
/// confidence interval, too.
pub(in crate::report) fn by_azimuth(
    piles: &[(String, &AngleOfRepose)],
) -> Result<Figure, ReportError> {
    let x = Axis::with_ticks(
        "Azimuth about the axis (°)",
        &[0.0, 60.0, 120.0, 180.0, 240.0, 300.0, 360.0],
    );
    let mut plot = Plot::new(x, Axis::linear("Slope of the flank (°)"));
    let mut table = Table::new(["pile", "azimuth_degrees", "degrees", "toe_radius_mm"]);
    if let [(_, pile)] = piles {
        let interval = (pile.confidence_low_degrees, pile.confidence_high_degrees);
        plot.add_band("95 % confidence interval of the mean", interval);
        plot.mark_level(format!("Mean, {:.1}°", pile.degrees), pile.degrees);
    }
    for (n, (name, pile)) in piles.iter().enumerate() {
        let points = pile.by_azimuth.iter().filter_map(|a| Some((a.azimuth_degrees, a.degrees?)));
        let label = if name.is_empty() { "Sector of 10°" } else { name };
        plot.add(label, Look::marked(n).thin(), points.collect());
        for a in &pile.by_azimuth {
            table.row(row![name, a.azimuth_degrees, a.degrees, a.toe_radius_mm]);
        }
    }
    let caption = "Slope of a pile's flank in sectors of 10° about its axis: straight lines fitted \
                   between the radii at which the pile stands at 80 % and at 20 % of its height. \
                   Neighbouring sectors share grains.";
    Figure::new("angle-by-azimuth", "Slope of the flank by azimuth", caption, &[plot], &table)
}
