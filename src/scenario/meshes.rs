//! Grains whose shapes are those of meshes, as scans give them.

use super::*;

parts! {
/// Grains with the shapes of meshes. With a sieve table, grains are drawn and
/// scaled until every fraction has its mass; without one they are taken in
/// their own size.
pub struct MeshGrains {
    /// OBJ, STL and PLY files, or patterns of their names such as `stones/*.stl`,
    /// relative to the scenario file; once loaded, relative to the working directory.
    /// Each object of an OBJ file and each solid of an STL file is a grain.
    pub meshes: Vec<String>, length 1 to 10000;
    /// Unit of length in the files, which do not say it themselves.
    pub mesh_unit: MeshUnit;
    /// Density of the solids, in kg/m³: from that of expanded polystyrene, one of the lightest solids,
    /// so that a value in g/cm³ is refused.
    pub density_kg_per_m3: f64, from 10.0 to 30000.0;
    /// Take the convex hull of grains that are not convex. Without it only those
    /// whose volume is at least 99 % of their hull's are taken as their hulls.
    pub hull: bool, or default;
    /// Separate closed surfaces in one object are grains of their own.
    pub split_surfaces: bool, or default;
    /// Most vertices a grain may have; the hull of one that has more is
    /// simplified, farthest vertices kept first.
    pub largest_vertex_count: u32, else "default_vertices", from 8 to 1000;
    /// Mass of all grains together in grams; with a sieve table, and only with one.
    pub total_mass_g: Option<f64>, skip "Option::is_none", above 0.0 to 1e9;
    /// Sieve fractions as of grains cut from sieve data, coarsest first. None:
    /// the grains keep their own size.
    pub sieve_table: Vec<SieveFraction>, skip "Vec::is_empty", length 1 to 100;
    /// Without a sieve table: how many grains are drawn; if not given, each is taken once.
    pub count: Option<u32>, skip "Option::is_none", from 1 to 1_000_000;
}
}

defaults! {
    default_vertices: u32 = 64;
}

/// Unit of length of a mesh file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MeshUnit {
    /// Micrometres.
    Um,
    /// Millimetres.
    Mm,
    /// Centimetres.
    Cm,
    /// Metres.
    M,
    /// Inches of 25.4 mm.
    Inch,
}

impl MeshUnit {
    /// All units, finest first.
    pub const ALL: [Self; 5] = [Self::Um, Self::Mm, Self::Cm, Self::Inch, Self::M];

    /// Length of the unit in m.
    pub fn metres(self) -> f64 {
        match self {
            Self::Um => 1e-6,
            Self::Mm => 1e-3,
            Self::Cm => 1e-2,
            Self::M => 1.0,
            Self::Inch => 0.0254,
        }
    }

    /// Its name in a scenario file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Um => "um",
            Self::Mm => "mm",
            Self::Cm => "cm",
            Self::M => "m",
            Self::Inch => "inch",
        }
    }
}

impl MeshGrains {
    /// What the grains are to weigh on each sieve, in the form of grains cut
    /// from sieve data; `None` where the grains keep their own size.
    pub fn as_sieved(&self) -> Option<SievedGrains> {
        if self.sieve_table.is_empty() {
            return None;
        }
        Some(SievedGrains {
            total_mass_g: self.total_mass_g?,
            density_kg_per_m3: self.density_kg_per_m3,
            sieve_table: self.sieve_table.clone(),
            shape: SievedShape::default(),
            cells: CellShape::default(),
        })
    }
}
