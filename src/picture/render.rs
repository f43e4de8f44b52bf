//! Renders a scene: a ray for every sample of a pixel, shaded by what it hits.
//!
//! One ray per pixel finds what is seen and what light falls on it; pixels on the
//! edge of a face or a body are drawn anew from nine rays. Each pixel is computed
//! by itself, so that the number of threads changes no bit.

use rayon::prelude::*;

use super::*;

/// Rays along one side of a pixel on an edge.
const FINE: usize = 3;
/// What the rays of a pixel see when it is nothing.
const NOTHING: u32 = u32::MAX;
/// The same of the ground.
const GROUND: u32 = u32::MAX - 1;
/// How far from everything shadows may fall, in radii of the scene.
const GROUND_REACH: f64 = 3.0;
/// Share of the picture's sides over which shadows on the ground fade away.
const FADE: f32 = 0.10;
/// Neighbouring pixels through which glass lets so unlike shares of the light lie on an edge of it.
const GLASS_EDGE: f32 = 0.03;

/// What a ray sees.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Seen {
    hit: Hit,
    /// Share of the light that the glass before it lets through.
    clear: f32,
}

impl Seen {
    fn same_face(&self, other: &Self) -> bool {
        self.hit.body == other.hit.body && self.hit.plane == other.hit.plane
    }
}

/// What a picture is made with.
struct Studio<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    light: Light,
    radius: f64,
    // Length of glass that lets 1/e of the light through, in m.
    glass_depth: f64,
    // Of the picture in pixels.
    size: [f32; 2],
}

/// A picture of a scene; `glass_depth` is the length of glass in m that lets 1/e
/// of the light through.
pub fn render(scene: &Scene, camera: &Camera, width: u32, height: u32, glass_depth: f64) -> Image {
    let radius = scene.radius();
    let light = Light::new(&camera.axes, 0.3 * radius);
    let size = [width as f32, height as f32];
    let studio = Studio { scene, camera, light, radius, glass_depth, size };
    let (columns, rows) = (width as usize, height as usize);
    let seen = by_pixel(columns, rows, |x, y| studio.look(x as f64 + 0.5, y as f64 + 0.5));
    let lit = by_pixel(columns, rows, |x, y| {
        let own = &seen[y * columns + x];
        studio.lit(own, &studio.ray(x, y), &samples_of(x, y)).unwrap_or_default()
    });
    // Averaged twice, once before and once after each pixel, so that nothing is shifted.
    let raw = Grid { columns, rows, seen: &seen, lit: &lit };
    let lit = by_pixel(columns, rows, |x, y| {
        let (back, ahead) = (SQUARE / 2, SQUARE - 1 - SQUARE / 2);
        raw.mean(&seen[y * columns + x], x, y, back, ahead).unwrap_or_default()
    });
    let grid = Grid { columns, rows, seen: &seen, lit: &lit };
    let pixels = by_pixel(columns, rows, |x, y| {
        let own = &seen[y * columns + x];
        if !grid.on_edge(x, y) {
            let lit = grid.mean(own, x, y, SQUARE - 1 - SQUARE / 2, SQUARE / 2);
            return studio.at_edge(x, y, studio.colour(own, &studio.ray(x, y), lit));
        }
        let mut sum = [0.0; 4];
        for n in 0..FINE * FINE {
            let part = |n: usize| (n as f64 + 0.5) / FINE as f64;
            let (px, py) = (x as f64 + part(n % FINE), y as f64 + part(n / FINE));
            let seen = studio.look(px, py);
            let ray = studio.camera.ray(px, py);
            let near = grid.mean(&seen, x, y, SQUARE / 2, SQUARE / 2);
            let lit = near.or_else(|| studio.lit(&seen, &ray, &samples_alone()));
            let colour = studio.colour(&seen, &ray, lit);
            sum = std::array::from_fn(|n| sum[n] + colour[n]);
        }
        studio.at_edge(x, y, sum.map(|c| c / (FINE * FINE) as f32))
    });
    Image { width, height, pixels }
}

/// Computes every pixel by itself, row by row.
fn by_pixel<T: Send>(
    columns: usize,
    rows: usize,
    pixel: impl Fn(usize, usize) -> T + Sync,
) -> Vec<T> {
    let pixels = (0..columns * rows).into_par_iter();
    pixels.map(|n| pixel(n % columns, n / columns)).collect()
}

impl Studio<'_> {
    fn ray(&self, x: usize, y: usize) -> Ray {
        self.camera.ray(x as f64 + 0.5, y as f64 + 0.5)
    }

    fn look(&self, x: f64, y: f64) -> Seen {
        let ray = self.camera.ray(x, y);
        let nothing = Hit { body: NOTHING, plane: 0, t: f64::MAX };
        let hit = self.scene.first_hit(&ray).or_else(|| self.ground(&ray)).unwrap_or(nothing);
        let length = self.scene.glass_on(&ray, hit.t);
        Seen { hit, clear: (-length / self.glass_depth).exp() as f32 }
    }

    /// The ground, where shadows may fall on it.
    fn ground(&self, ray: &Ray) -> Option<Hit> {
        let height = self.scene.ground?;
        let t = (height - ray.origin.z) / ray.direction.z;
        let before = ray.direction.z < 0.0 && t > 0.0;
        let near = ray.at(t).norm() < GROUND_REACH * self.radius + ray.at(t).z.abs();
        (before && near).then_some(Hit { body: GROUND, plane: 0, t })
    }

    fn normal(&self, Hit { body, plane, t }: Hit, ray: &Ray) -> Option<Vector> {
        match body {
            NOTHING => None,
            GROUND => Some(Vector::z()),
            body => Some(self.scene.normal(body, plane, &ray.at(t))),
        }
    }

    /// The light that samples find on what a ray sees, where that is anything.
    fn lit(&self, seen: &Seen, ray: &Ray, samples: &[usize]) -> Option<Lit> {
        let normal = self.normal(seen.hit, ray)?;
        let at = ray.at(seen.hit.t);
        Some(self.light.gather(self.scene, at, &normal, seen.hit.body, samples))
    }

    /// A pixel's colour, where shadows that the picture would cut off fade away.
    fn at_edge(&self, x: usize, y: usize, colour: [f32; 4]) -> [f32; 4] {
        // Shadows are black; what else there is lies well within the picture.
        if colour[..3] != [0.0; 3] {
            return colour;
        }
        let free = |at: usize, side: f32| {
            let at = at as f32 + 0.5;
            (at.min(side - at) / (FADE * side)).min(1.0)
        };
        let share = free(x, self.size[0]).min(free(y, self.size[1]));
        [0.0, 0.0, 0.0, colour[3] * share * share * (3.0 - 2.0 * share)]
    }

    /// Colour with alpha, both multiplied already.
    fn colour(&self, seen: &Seen, ray: &Ray, lit: Option<Lit>) -> [f32; 4] {
        let lit = lit.unwrap_or_default();
        let Hit { body, plane, t } = seen.hit;
        let behind = match self.normal(seen.hit, ray) {
            None => [0.0; 4],
            Some(_) if body == GROUND => {
                // Shadows end softly where the ground does.
                let far = ray.at(t).norm() / (GROUND_REACH * self.radius);
                let fade = (4.0 * (1.0 - far)).clamp(0.0, 1.0) as f32;
                [0.0, 0.0, 0.0, fade * Light::shadow(lit)]
            }
            Some(normal) => {
                let body = &self.scene.bodies[body as usize];
                let plane = plane as usize;
                let section = plane != BALL && plane >= body.sections_from;
                let colour = if section { Colour::SECTION } else { body.colour };
                let [r, g, b] = self.light.shade(colour, &normal, lit);
                [r, g, b, 1.0]
            }
        };
        let [r, g, b] = Colour::GLASS.0.map(|c| c * (1.0 - seen.clear));
        let glass = [r, g, b, 1.0 - seen.clear];
        std::array::from_fn(|n| glass[n] + seen.clear * behind[n])
    }
}

/// What all pixels see.
struct Grid<'a> {
    columns: usize,
    rows: usize,
    seen: &'a [Seen],
    lit: &'a [Lit],
}

impl Grid<'_> {
    /// Numbers of the pixels around one, from `back` before to `ahead` after it.
    fn around(&self, x: usize, y: usize, back: usize, ahead: usize) -> impl Iterator<Item = usize> {
        let columns = self.columns;
        let rows = y.saturating_sub(back)..=(y + ahead).min(self.rows - 1);
        let across = x.saturating_sub(back)..=(x + ahead).min(columns - 1);
        rows.flat_map(move |y| across.clone().map(move |x| y * columns + x))
    }

    fn on_edge(&self, x: usize, y: usize) -> bool {
        let own = &self.seen[y * self.columns + x];
        self.around(x, y, 1, 1).any(|n| {
            let other = &self.seen[n];
            !own.same_face(other) || (own.clear - other.clear).abs() > GLASS_EDGE
        })
    }

    /// The light on a surface over the pixels around one that show it; none where none does.
    fn mean(&self, seen: &Seen, x: usize, y: usize, back: usize, ahead: usize) -> Option<Lit> {
        let (mut sum, mut count) = (Lit::default(), 0);
        for n in self.around(x, y, back, ahead).filter(|&n| seen.same_face(&self.seen[n])) {
            sum.sky += self.lit[n].sky;
            sum.lamp += self.lit[n].lamp;
            count += 1;
        }
        let count_f = count as f32;
        (count > 0).then(|| Lit { sky: sum.sky / count_f, lamp: sum.lamp / count_f })
    }
}

#[cfg(test)]
#[path = "render_tests.rs"]
mod tests;
