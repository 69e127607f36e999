//! How much faster than real time a world runs: `cargo run --release -p selfneg-sim --example speed`.

use std::error::Error;
use std::io::Write as _;
use std::time::Instant;

use selfneg_sim::{Activity, Building, Command, Person, Point, Settings, World};

fn main() -> Result<(), Box<dyn Error>> {
    for crowd in [0_u32, 5, 20] {
        let building = Building::mall()?;
        let places: Vec<String> = building.places().map(|(_, p)| p.name.clone()).collect();
        let before = Instant::now();
        let mut world = World::new(building, Settings::default(), "entrance")?;
        let ready = before.elapsed();
        for i in 0..crowd {
            let x = 1.0 + 1.2 * f64::from(i);
            let walk = [Point::new(x, 11.2), Point::new(x, 5.8)];
            // Those whose walk would lead through a planter stay at home.
            let _ = world.add_person(Person {
                repeat: true,
                ..Person::standing(&format!("p{i}"), 0, walk[1]).walking(&walk)
            });
        }
        let before = Instant::now();
        let mut arrived = 0;
        for place in &places {
            let mut events = world.step(Command::go_to(place));
            while world.activity() != Activity::Idle {
                events = world.step(Command::Continue);
            }
            arrived += u32::from(events.iter().any(|e| matches!(e, selfneg_sim::Event::Arrived { .. })));
        }
        let (simulated, took) = (world.time().as_secs_f64(), before.elapsed().as_secs_f64());
        writeln!(
            std::io::stdout(),
            "{} people: {simulated:.0} s of simulated time in {took:.3} s, {:.0} times real time; \
             {arrived} of {} places; set-up {:.1} ms",
            world.people().count(),
            simulated / took,
            places.len(),
            ready.as_secs_f64() * 1e3,
        )?;
    }
    Ok(())
}
