//! The camera: it stands on an orbit around what it looks at, and backs off until
//! everything is in the picture.

use std::fmt;

use super::*;
use crate::units::from_deg;

/// Half the angle between the picture's farther sides, in degrees: a mild telephoto lens (about 80
/// mm on 35 mm film), so that heights are seen nearly as in a drawing.
const HALF_ANGLE_DEG: f64 = 12.0;

/// Share of the picture left free on each side.
const MARGIN: f64 = 0.035;

/// From where one looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Direction from what is seen to the camera, seen from above, in degrees
    /// counter-clockwise from the -y axis: at 0 the x axis, along which the table
    /// shakes, runs to the right; at 90 one looks along -x.
    pub azimuth_deg: f64,
    /// Height of the camera above the horizon in degrees, -89 to 89.
    pub elevation_deg: f64,
}

impl Default for View {
    fn default() -> Self {
        Self { azimuth_deg: 25.0, elevation_deg: 18.0 }
    }
}

impl fmt::Display for View {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "azimuth {}°, elevation {}°", self.azimuth_deg, self.elevation_deg)
    }
}

impl View {
    /// Unit vectors to the right, upwards in the picture, and towards the camera.
    pub fn axes(&self) -> [Vector; 3] {
        let (azimuth, elevation) = (from_deg(self.azimuth_deg), from_deg(self.elevation_deg));
        let right = Vector::new(azimuth.cos(), azimuth.sin(), 0.0);
        let back = elevation.cos() * self.level() + elevation.sin() * Vector::z();
        [right, back.cross(&right), back]
    }

    /// Horizontal unit vector towards the camera.
    pub fn level(&self) -> Vector {
        let azimuth = from_deg(self.azimuth_deg);
        Vector::new(azimuth.sin(), -azimuth.cos(), 0.0)
    }
}

/// Height over width of a picture that these points fill, seen from far off; 1 without points.
pub fn aspect(points: &[Point], view: &View) -> f64 {
    let [right, up, _] = view.axes();
    let extent = |axis: Vector| {
        let along = points.iter().map(|p| axis.dot(&p.coords));
        let ends = along.fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)));
        ends.1 - ends.0
    };
    let (wide, high) = (extent(right), extent(up));
    if wide > 0.0 && high > 0.0 { high / wide } else { 1.0 }
}

/// A camera in its place, for a picture of a number of pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    eye: Vector,
    /// Unit vectors to the right, upwards, and towards the camera.
    pub axes: [Vector; 3],
    // Length of a pixel on the plane at distance 1.
    pixel: f64,
    width: f64,
    height: f64,
}

impl Camera {
    /// The camera of a view that has all of the points in the picture, as large as that allows.
    pub fn framing(points: &[Point], view: &View, width: u32, height: u32) -> Self {
        let axes = view.axes();
        let (width, height) = (f64::from(width.max(1)), f64::from(height.max(1)));
        let tangent = from_deg(HALF_ANGLE_DEG).tan();
        let pixel = 2.0 * tangent / width.max(height);
        // Tangents up to which points may be seen, to the side and upwards.
        let free = 1.0 - 2.0 * MARGIN;
        let within = [free * pixel * width / 2.0, free * pixel * height / 2.0];
        let mut camera = Self { eye: axes[2], axes, pixel, width, height };
        if points.is_empty() {
            return camera;
        }
        // Along both axes of the picture the outermost points bound where the eye
        // may stand: right - x <= within · (back - z) for the point farthest to the
        // right, and so on. Both bounds meet where the eye stands in the middle.
        let seen = |p: &Point| axes.map(|axis| axis.dot(&p.coords));
        let mut place = [0.0, 0.0, f64::NEG_INFINITY];
        for side in 0..2 {
            let most = |sign: f64| {
                let bounds = points.iter().map(seen).map(|p| sign * p[side] + within[side] * p[2]);
                bounds.fold(f64::NEG_INFINITY, f64::max)
            };
            let (upper, lower) = (most(1.0), most(-1.0));
            place[side] = (upper - lower) / 2.0;
            place[2] = f64::max(place[2], (upper + lower) / (2.0 * within[side]));
        }
        // Never within what is seen.
        let nearest = points.iter().map(|p| seen(p)[2]).fold(f64::NEG_INFINITY, f64::max);
        place[2] = place[2].max(nearest + 1e-3);
        camera.eye = place[0] * axes[0] + place[1] * axes[1] + place[2] * axes[2];
        camera
    }

    /// The ray through a point of the picture, in pixels from its upper left corner.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let side = (x - self.width / 2.0) * self.pixel;
        let up = (self.height / 2.0 - y) * self.pixel;
        let direction = side * self.axes[0] + up * self.axes[1] - self.axes[2];
        Ray { origin: self.eye, direction: direction.normalize() }
    }

    #[cfg(test)]
    /// Where a point is seen, in pixels from the upper left corner; none behind the camera.
    pub fn project(&self, point: &Point) -> Option<(f64, f64)> {
        let away = point.coords - self.eye;
        let depth = -away.dot(&self.axes[2]);
        if !(depth > 0.0) {
            return None;
        }
        let scale = 1.0 / (depth * self.pixel);
        let x = self.width / 2.0 + away.dot(&self.axes[0]) * scale;
        Some((x, self.height / 2.0 - away.dot(&self.axes[1]) * scale))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::testing::near;

    fn cloud() -> Vec<Point> {
        let mut points = Vec::new();
        for n in 0..8 {
            let pick = |axis: u32, low: f64, high: f64| if n >> axis & 1 == 0 { low } else { high };
            points.push(Point::new(pick(0, -0.1, 0.3), pick(1, 0.0, 0.2), pick(2, -0.05, 0.4)));
        }
        points
    }

    #[test]
    fn everything_is_framed_and_fills_the_picture() {
        for (width, height) in [(1600, 1200), (300, 900), (1000, 10)] {
            for azimuth_deg in [0.0, 25.0, 135.0, -70.0] {
                for elevation_deg in [-30.0, 0.0, 18.0, 89.0] {
                    let view = View { azimuth_deg, elevation_deg };
                    let camera = Camera::framing(&cloud(), &view, width, height);
                    let (mut x, mut y) = (vec![], vec![]);
                    for p in cloud() {
                        let seen = camera.project(&p).expect("in front of the camera");
                        x.push(seen.0 / f64::from(width));
                        y.push(seen.1 / f64::from(height));
                    }
                    let ends = |v: &[f64]| {
                        v.iter().fold((f64::MAX, f64::MIN), |(a, b), &v| (a.min(v), b.max(v)))
                    };
                    let (x, y) = (ends(&x), ends(&y));
                    for (low, high) in [x, y] {
                        let inside = low > MARGIN - 1e-9 && high < 1.0 - MARGIN + 1e-9;
                        assert!(inside, "law: within the margins, got {low} to {high} ({view})");
                    }
                    let filled = (x.1 - x.0).max(y.1 - y.0);
                    let expected = 1.0 - 2.0 * MARGIN;
                    near(&format!("one side is filled, {view}"), filled, expected, 1e-9);
                }
            }
        }
    }

    #[test]
    fn an_aspect_is_that_of_what_is_seen() {
        let front = View { azimuth_deg: 0.0, elevation_deg: 0.0 };
        let got = aspect(&cloud(), &front);
        assert!((got - 0.45 / 0.4).abs() < 1e-12, "law: height over width, got {got}");
        assert_eq!(aspect(&[], &front), 1.0, "nothing is square");
    }

    #[test]
    fn rays_go_back_where_points_are_seen() {
        let camera = Camera::framing(&cloud(), &View::default(), 800, 600);
        for p in cloud() {
            let (x, y) = camera.project(&p).expect("in front");
            let ray = camera.ray(x, y);
            let off = (p.coords - ray.origin).cross(&ray.direction).norm();
            assert!(off < 1e-12, "law: the ray meets the point, off by {off} m, tolerance 1e-12");
        }
        let behind = Point::from(camera.ray(0.0, 0.0).at(-1.0));
        assert_eq!(camera.project(&behind), None, "law: nothing is seen behind the camera");
    }

    #[test]
    fn the_view_is_where_it_says() {
        let [right, up, back] = View { azimuth_deg: 0.0, elevation_deg: 0.0 }.axes();
        let close = |a: Vector, b: Vector| (a - b).norm() < 1e-15;
        assert!(close(right, Vector::x()) && close(up, Vector::z()), "{right} {up}");
        assert!(close(back, -Vector::y()), "law: at azimuth 0 the camera stands at -y, {back}");
        let back = View { azimuth_deg: 90.0, elevation_deg: 0.0 }.axes()[2];
        assert!(close(back, Vector::x()), "law: at azimuth 90 it stands at +x, {back}");
        let [right, up, back] = View { azimuth_deg: 40.0, elevation_deg: 55.0 }.axes();
        assert!(close(right.cross(&up), back), "law: right, up and back are right-handed");
    }

    #[test]
    fn nothing_to_see_is_no_fault() {
        let camera = Camera::framing(&[], &View::default(), 10, 10);
        assert!(camera.ray(5.0, 5.0).direction.norm() > 0.99);
    }
}
