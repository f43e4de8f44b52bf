//! Trial.
use super::{case, setting};
use pluvia::scenario::{EngineSettings, FrictionModel};
use pluvia::verify::{Setting, verify};

#[test]
fn trial_rapier_causes() {
    let base = setting("rapier").engine;
    let mut all: Vec<(&str, EngineSettings)> = vec![("as is", base.clone())];
    let mut add = |name, change: &dyn Fn(&mut EngineSettings)| {
        let mut e = base.clone();
        change(&mut e);
        all.push((name, e));
    };
    add("relax 10", &|e| e.rapier.relaxing_sweeps = 10);
    add("relax 100", &|e| e.rapier.relaxing_sweeps = 100);
    add("sweeps 10 relax 10", &|e| (e.rapier.relaxing_sweeps, e.rapier.sweeps) = (10, 10));
    add("sweeps 100 relax 100", &|e| (e.rapier.relaxing_sweeps, e.rapier.sweeps) = (100, 100));
    add("friction while correcting, 100", &|e| {
        (e.rapier.relaxing_sweeps, e.rapier.sweeps) = (100, 100);
        e.rapier.friction_while_correcting = true;
    });
    add("substeps 16", &|e| e.rapier.substeps = 16);
    add("substeps 64", &|e| e.rapier.substeps = 64);
    add("frequency 100", &|e| {
        (e.rapier.contact_frequency_hz, e.rapier.wall_contact_frequency_hz) = (100.0, 100.0)
    });
    add("frequency 2000", &|e| {
        (e.rapier.contact_frequency_hz, e.rapier.wall_contact_frequency_hz) = (2000.0, 2000.0)
    });
    add("damping 10", &|e| {
        (e.rapier.contact_damping_ratio, e.rapier.wall_contact_damping_ratio) = (10.0, 10.0)
    });
    add("coulomb", &|e| e.rapier.friction_model = FrictionModel::Coulomb);
    add("coulomb 100", &|e| {
        e.rapier.friction_model = FrictionModel::Coulomb;
        (e.rapier.relaxing_sweeps, e.rapier.sweeps) = (100, 100);
    });
    add("no recycling", &|e| e.rapier.contact_recycling = false);
    add("1000 Hz", &|e| e.rate_hz = 1000.0);
    add("4000 Hz", &|e| e.rate_hz = 4000.0);
    add("corrective 0.3", &|e| e.rapier.corrective_speed_m_per_s = 0.3);
    add("corrective 30", &|e| e.rapier.corrective_speed_m_per_s = 30.0);
    for id in [
        "impact-flat-plastic",
        "impact-tilted-plastic",
        "impact-tilted-slip-stops",
        "rocking-block-flying",
        "top-keeps-tilt",
        "table-sticks",
        "table-slips",
        "packing-walls-hold",
        "inner-edge",
        "inner-edge-spinning",
        "rebound-again",
    ] {
        let case = case(id);
        for (name, engine) in &all {
            let v = verify(
                &case,
                &Setting { name: "rapier".into(), engine: engine.clone() },
                &pluvia::world::create,
            );
            println!("TRIAL {id} | {name} | {:?} | tol {} | {:?}", v.got, v.tolerance, v.note);
        }
    }
}

#[test]
fn trial_stock_causes() {
    let _ = setting("bullet");
    for id in ["rocking-block-flying", "top-keeps-tilt", "arch-critical-friction"] {
        for name in ["bullet", "bullet-960"] {
            let v = verify(&case(id), &setting(name), &pluvia::world::create);
            println!("TRIAL {id} | {name} | {:?} | {:?}", v.got, v.note);
        }
    }
}
