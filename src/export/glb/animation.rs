//! How nodes move: channels of one glTF animation.

use super::*;

/// An animation in the making, with a key at each of its times.
#[derive(Debug)]
pub struct Animation {
    times: Vec<[f32; 1]>,
    input: Option<usize>,
    channels: Vec<Value>,
    samplers: Vec<Value>,
}

impl Animation {
    /// With keys at times in s, which begin at 0 and rise.
    pub fn new(times: Vec<[f32; 1]>) -> Self {
        Self { times, input: None, channels: Vec::new(), samplers: Vec::new() }
    }

    fn channel<const N: usize>(
        &mut self,
        node: usize,
        path: &str,
        how: &str,
        values: &[[f32; N]],
        buffers: &mut Buffers,
    ) {
        let output = buffers.floats(Use::Animation, values);
        let times = &self.times;
        let input = *self.input.get_or_insert_with(|| buffers.floats(Use::Animation, times));
        self.channels.push(json!({
            "sampler": self.samplers.len(), "target": { "node": node, "path": path }
        }));
        self.samplers.push(json!({ "input": input, "interpolation": how, "output": output }));
    }

    /// Moves a node through its poses, one a time; none where it is not there:
    /// it then has no size. What never changes gets no channel.
    pub fn node(&mut self, node: usize, poses: &[Option<Pose>], buffers: &mut Buffers) {
        let whole = with_none_filled(poses);
        let Some(first) = whole.first() else { return };
        let same = |differs: &dyn Fn(&Pose) -> bool| !whole.iter().any(differs);
        if !same(&|p: &Pose| p.translation != first.translation) {
            let place = |p: &Pose| p.translation.vector.map(|x| x as f32).into();
            let places: Vec<[f32; 3]> = whole.iter().map(place).collect();
            self.channel(node, "translation", "LINEAR", &places, buffers);
        }
        if !same(&|p: &Pose| p.rotation != first.rotation) {
            self.channel(node, "rotation", "LINEAR", &turns(&whole), buffers);
        }
        if poses.iter().any(Option::is_none) {
            let sizes: Vec<[f32; 3]> =
                poses.iter().map(|p| [if p.is_some() { 1.0 } else { 0.0 }; 3]).collect();
            self.channel(node, "scale", "STEP", &sizes, buffers);
        }
    }

    /// The animation; none where nothing moves.
    pub fn finish(self, name: &str) -> Option<Value> {
        let Self { channels, samplers, .. } = self;
        (!channels.is_empty())
            .then(|| json!({ "name": name, "channels": channels, "samplers": samplers }))
    }
}

/// Poses with those that are missing taken from before, or else from after.
fn with_none_filled(poses: &[Option<Pose>]) -> Vec<Pose> {
    let Some(mut last) = poses.iter().flatten().next().copied() else { return Vec::new() };
    let filled = poses.iter().map(|pose| {
        last = pose.unwrap_or(last);
        last
    });
    filled.collect()
}

/// Rotations as quaternions, each with the sign that is nearer to the one
/// before: q and -q are the same rotation, but not half way between two.
fn turns(poses: &[Pose]) -> Vec<[f32; 4]> {
    let mut before = nalgebra::Vector4::zeros();
    let turns = poses.iter().map(|pose| {
        let q = pose.rotation.coords;
        let q = if q.dot(&before) < 0.0 { -q } else { q };
        before = q;
        [q.x as f32, q.y as f32, q.z as f32, q.w as f32]
    });
    turns.collect()
}
