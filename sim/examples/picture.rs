//! Draws a tour through the mall: `cargo run -p selfneg-sim --example picture > mall.svg`.

use std::error::Error;
use std::io::Write as _;

use selfneg_sim::{Activity, Building, Command, Person, Picture, Point, Settings, World, svg};

fn main() -> Result<(), Box<dyn Error>> {
    let mut world = World::new(Building::mall()?, Settings::default(), "charging station")?;
    world.add_person(Person::standing("Alice", 0, Point::new(11.7, 4.2)))?;
    world.add_person(Person::standing("Bob", 0, Point::new(16.4, 3.2)))?;
    world.add_person(
        Person::standing("Carol", 0, Point::new(3.2, 6.4))
            .walking(&[Point::new(6.6, 7.4), Point::new(9.4, 9.6)]),
    )?;
    world.add_person(Person::standing("Dan", 1, Point::new(8.6, 8.4)))?;
    world.add_person(Person { heading: 2.4, ..Person::standing("Erin", 1, Point::new(19.4, 6.6)) })?;
    let mut trails = [Vec::new(), Vec::new()];
    for place in ["bathroom", "pharmacy", "food court", "lounge", "clinic"] {
        world.step(Command::go_to(place));
        for step in 0..10_000 {
            if step % 5 == 0
                && let Some(trail) = trails.get_mut(world.robot().floor)
            {
                trail.push(world.robot().pose.position);
            }
            world.step(Command::Continue);
            let nearly_there =
                world.progress().is_some_and(|p| p.place == "clinic" && p.remaining.distance < 6.0);
            if world.activity() == Activity::Idle || nearly_there {
                break;
            }
        }
    }
    let pictures: Vec<Picture<'_>> =
        trails.iter().enumerate().map(|(floor, trail)| Picture::of(&world, floor).trail(trail)).collect();
    std::io::stdout().write_all(svg(&pictures).as_bytes())?;
    Ok(())
}
