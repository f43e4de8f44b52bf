//! A pile of grains: its side view with the fitted flanks, and its slope by azimuth.

use plotters::style::{
    Color, RGBColor,
    text_anchor::{HPos, VPos},
};

use super::*;
use crate::geometry::Vector;
use crate::measure;
use crate::record::AzimuthAngle;
use crate::report::{
    sheet::{Drawn, Place, Sheet, drawn, whole},
    silhouette::{Facet, facets},
    style::INK,
};

/// Directions within this angle in degrees of right and left give the drawn lines.
const SIDE_DEGREES: f64 = 30.0;
/// Most of the width that the scale bar takes.
const SCALE_BAR: f64 = 0.25;
/// Space in SVG units above the pile, for the angle, and below, for the scale.
const ABOVE: i32 = 150;
const BELOW: i32 = 170;
/// Colour of a face that looks to the light, in red, green and blue.
const GRAIN: [f64; 3] = [222.0, 212.0, 194.0];
const FIXED: [f64; 3] = [168.0, 174.0, 180.0];
/// Share of the light that a face turned away from it still has.
const SHADE: f64 = 0.42;

/// The mean of fitted lines on a side of the pile.
struct Side {
    name: &'static str,
    /// 1 to the right, −1 to the left.
    sign: f64,
    /// Positive where it falls outwards.
    slope: f64,
    /// Height in mm above the base at which it meets the axis.
    at_axis_mm: f64,
}

impl Side {
    /// Right and left, of the sectors near them; without one that does not fall outwards.
    fn both(pile: &AngleOfRepose) -> Vec<Self> {
        let line = |a: &AzimuthAngle| {
            let slope = a.degrees?.to_radians().tan();
            Some((slope, slope * a.toe_radius_mm?))
        };
        let side = |(name, sign, towards_degrees): (&'static str, f64, f64)| {
            let near = |a: &&AzimuthAngle| {
                let apart = (a.azimuth_degrees - towards_degrees + 540.0).rem_euclid(360.0) - 180.0;
                apart.abs() <= SIDE_DEGREES
            };
            let lines = pile.by_azimuth.iter().filter(near).filter_map(line);
            let (slopes, at_axis_mm): (Vec<f64>, Vec<f64>) = lines.unzip();
            let (slope, at_axis_mm) = (mean(&slopes)?, mean(&at_axis_mm)?);
            (slope > 0.0).then_some(Self { name, sign, slope, at_axis_mm })
        };
        [("right", 1.0, 0.0), ("left", -1.0, 180.0)].into_iter().filter_map(side).collect()
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
    let sides = Side::both(pile);
    let table = table!(&sides, |side| {
        "side" => side.name,
        "degrees" => side.degrees(),
        "toe_radius_mm" => side.toe_mm(),
        "axis_x_mm" => pile.axis_mm[0],
        "base_level_mm" => base_level_mm,
    });
    let svg = Picture::new(specimen, pile, base_level_mm).svg(&sides);
    let caption = format!(
        "The pile seen along y. {} The interval is that of this pile's mean slope; other piles may \
         lie outside.",
        lines_in_words(&sides)
    );
    Figure::of_svg("pile", "Side view of the pile", caption, svg, &table)
}

/// What a caption says of the fitted lines, of the sides that have one.
fn lines_in_words(sides: &[Side]) -> String {
    let line = match sides {
        [] => return "No line: neither side has a fitted flank that falls outwards.".to_owned(),
        [one] => format!(
            "The line is the fitted flank on the {}, the mean over the sectors within \
             {SIDE_DEGREES}° of it, drawn solid where it is fitted; the other side has none that \
             falls outwards. It follows",
            one.name
        ),
        _ => format!(
            "The lines are the fitted flanks on either side, means over the sectors within \
             {SIDE_DEGREES}° of it, drawn solid where they are fitted. They follow"
        ),
    };
    line + " the mean surface of a sector; grains of the silhouette stand in front of it."
}

/// Space in mm around what is drawn of a pile on a base of a radius in mm: on those of the paper's
/// piles 12.
fn margin_mm(radius_mm: f64) -> f64 {
    12f64.clamp(radius_mm / 15.0, radius_mm / 10.0)
}

/// Height in mm of the floor as drawn, on the same bases 20: what is sunk into it does not show below.
fn floor_mm(radius_mm: f64) -> f64 {
    20f64.clamp(radius_mm / 9.0, radius_mm / 6.0)
}

/// Length in mm of the scale bar of a view of a width in mm: 1, 2 or 5 times a power of ten.
fn scale_bar_mm(width_mm: f64) -> f64 {
    let most = SCALE_BAR * width_mm;
    let power = 10f64.powi(most.log10().floor() as i32);
    [5.0, 2.0].into_iter().map(|m| m * power).find(|length| *length <= most).unwrap_or(power)
}

/// What the side view shows, and how millimetres become SVG units.
struct Picture<'a> {
    pile: &'a AngleOfRepose,
    base_level_mm: f64,
    facets: Vec<Facet>,
    left_mm: f64,
    top_mm: f64,
    floor_mm: f64,
    scale: f64,
    height: i32,
}

impl<'a> Picture<'a> {
    fn new(specimen: &Specimen, pile: &'a AngleOfRepose, base_level_mm: f64) -> Self {
        let base = specimen.state.base.as_ref();
        let radius_mm = base.map_or(pile.base_radius_mm, |base| to_mm(base.radius));
        let (margin_mm, floor_mm) = (margin_mm(radius_mm), floor_mm(radius_mm));
        let top_mm = base_level_mm + pile.pile_height_mm + margin_mm;
        let scale = f64::from(style::WIDTH) / (2.0 * (radius_mm + margin_mm));
        Self {
            pile,
            base_level_mm,
            facets: facets(specimen),
            left_mm: -radius_mm - margin_mm,
            top_mm,
            floor_mm,
            scale,
            height: ABOVE + ((top_mm + floor_mm) * scale) as i32 + BELOW,
        }
    }

    fn at(&self, x_mm: f64, z_mm: f64) -> (f64, f64) {
        ((x_mm - self.left_mm) * self.scale, f64::from(ABOVE) + (self.top_mm - z_mm) * self.scale)
    }

    fn svg(&self, sides: &[Side]) -> Result<String, String> {
        drawn(self.height, |sheet| {
            self.facets.iter().try_for_each(|facet| self.facet(sheet, facet))?;
            // The floor hides what of the fixed grains is sunk into it.
            self.floor(sheet)?;
            sides.iter().try_for_each(|side| self.flank(sheet, side))?;
            self.angle(sheet)?;
            self.scale_bar(sheet)
        })
    }

    fn floor(&self, sheet: &Sheet) -> Drawn {
        let (left, right) = (self.left_mm, -self.left_mm);
        let (upper_left, lower_right) = (self.at(left, 0.0), self.at(right, -self.floor_mm));
        sheet.rectangle([whole(upper_left), whole(lower_right)], style::BAND.filled())?;
        sheet.path([whole(upper_left), whole(self.at(right, 0.0))], INK, style::THIN)
    }

    fn facet(&self, sheet: &Sheet, facet: &Facet) -> Drawn {
        let light = Vector::new(-0.45, -0.6, 0.66).normalize();
        let lit = SHADE + (1.0 - SHADE) * facet.normal.dot(&light).max(0.0);
        let ground = if facet.fixed { FIXED } else { GRAIN };
        let [r, g, b] = ground.map(|c| (c * lit).round() as u8);
        let corners: Vec<Place> =
            facet.corners.iter().map(|c| whole(self.at(to_mm(c.0), to_mm(c.1)))).collect();
        sheet.polygon(corners.clone(), RGBColor(r, g, b))?;
        let [r, g, b] = ground.map(|c| (c * lit * 0.72).round() as u8);
        let closed: Vec<Place> = corners.iter().chain(corners.first()).copied().collect();
        sheet.path(closed, RGBColor(r, g, b), 1)
    }

    /// The fitted line of one side, with its angle beside it.
    fn flank(&self, sheet: &Sheet, side: &Side) -> Drawn {
        let point = |r: f64| {
            let height = side.at_axis_mm - side.slope * r;
            self.at(self.pile.axis_mm[0] + side.sign * r, self.base_level_mm + height)
        };
        let colour = style::colour(1);
        sheet.dashed(&[point(0.0), point(side.toe_mm())], style::DASHED, colour, 4)?;
        sheet.path(self.pile.flank_radii_mm.map(|r| whole(point(r))), colour, 9)?;
        let (x, y) = point(0.4 * side.toe_mm());
        let anchor = if side.sign > 0.0 { HPos::Left } else { HPos::Right };
        let at = (x as i32 + (side.sign * 110.0) as i32, y as i32 - 80);
        let text = format!("{:.1}°", side.degrees());
        sheet.text(&text, at, style::NAMES, (anchor, VPos::Center))
    }

    fn angle(&self, sheet: &Sheet) -> Drawn {
        let text = angle_in_words(self.pile);
        let at = (style::WIDTH as i32 / 2, ABOVE / 2);
        sheet.text(&text, at, style::NUMBERS, (HPos::Center, VPos::Center))
    }

    fn scale_bar(&self, sheet: &Sheet) -> Drawn {
        let y = self.height - BELOW / 2;
        let x = style::LEFT / 2;
        let length_mm = scale_bar_mm(f64::from(style::WIDTH) / self.scale);
        let end = x + (length_mm * self.scale) as i32;
        sheet.rectangle([(x, y), (end, y + 12)], INK.filled())?;
        let text = format!("{length_mm} mm");
        sheet.text(&text, (end + 30, y + 6), style::NUMBERS, (HPos::Left, VPos::Center))
    }
}

/// The angle of a pile with its interval.
fn angle_in_words(of: &AngleOfRepose) -> String {
    format!(
        "Angle of repose {:.1}° (95 % confidence {:.1}° to {:.1}°), mean of all directions",
        of.degrees, of.confidence_low_degrees, of.confidence_high_degrees
    )
}

/// The slope of each sector of piles, by name; one pile shows its mean and its
/// confidence interval, too.
pub(crate) fn by_azimuth(piles: &[(&str, &AngleOfRepose)]) -> Result<Figure, ReportError> {
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
    for (n, &(name, pile)) in piles.iter().enumerate() {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::canned;

    /// Law: an interval says of what it is: the confidence of the mean slope, no share of a pile.
    #[test]
    fn the_interval_of_a_pile_is_called_its_confidence() {
        let pile = canned::pile(1, Some(43.44)).summary.angle_of_repose.expect("an angle");
        let expected =
            "Angle of repose 43.4° (95 % confidence 42.4° to 44.4°), mean of all directions";
        assert_eq!(angle_in_words(&pile), expected);
    }

    /// Law: the caption speaks of the lines that are drawn: of a side whose sectors have no flank
    /// there is none.
    #[test]
    fn the_caption_is_of_the_lines_that_are_drawn() {
        let pile = canned::pile(1, Some(43.44)).summary.angle_of_repose.expect("an angle");
        let sector = |azimuth_degrees: f64| AzimuthAngle {
            azimuth_degrees,
            degrees: Some(43.0),
            toe_radius_mm: Some(80.0),
        };
        for (azimuths, expected) in [
            (&[0.0, 180.0][..], "The lines are the fitted flanks on either side"),
            (&[0.0][..], "The line is the fitted flank on the right"),
            (&[180.0][..], "The line is the fitted flank on the left"),
            (&[90.0][..], "No line: neither side has a fitted flank"),
        ] {
            let by_azimuth = azimuths.iter().map(|azimuth| sector(*azimuth)).collect();
            let sides = Side::both(&AngleOfRepose { by_azimuth, ..pile.clone() });
            let got = lines_in_words(&sides);
            assert!(got.starts_with(expected), "law: of {azimuths:?} `{expected}`, got `{got}`");
        }
    }

    /// Law: space, floor and scale bar of the side view grow with the base, and the scale bar with its
    /// number stays on the sheet; views of the usual bases have 12, 20 and 50 mm.
    #[test]
    fn a_side_view_fits_its_base() {
        for radius_mm in [120.0, 180.0] {
            let width_mm = 2.0 * (radius_mm + margin_mm(radius_mm));
            let got = [margin_mm(radius_mm), floor_mm(radius_mm), scale_bar_mm(width_mm)];
            assert_eq!(got, [12.0, 20.0, 50.0], "law: of a base of {radius_mm} mm");
        }
        for radius_mm in [0.5, 10.0, 37.0, 5000.0] {
            let width_mm = 2.0 * (radius_mm + margin_mm(radius_mm));
            let share = scale_bar_mm(width_mm) / width_mm;
            assert!((0.1..=0.25).contains(&share), "law: of {radius_mm} mm a quarter, got {share}");
            let spaces = [margin_mm(radius_mm), floor_mm(radius_mm)].map(|mm| mm / radius_mm);
            assert!(
                spaces.iter().all(|share| (0.06..0.17).contains(share)),
                "law: a sixth of {radius_mm} mm at most, got {spaces:?}"
            );
        }
        assert_eq!(scale_bar_mm(22.0), 5.0, "law: of a base of 20 mm");
    }
}
