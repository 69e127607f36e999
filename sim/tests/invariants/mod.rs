//! What must hold after every step, whatever happens.

use selfneg_sim::{Command, Event, Point, Robot, World};

const ROUNDING: f64 = 1e-9;

/// Compares each step with the one before.
pub(crate) struct Watch {
    last: Robot,
    last_people: Vec<(String, Point)>,
}

impl Watch {
    pub(crate) fn new(world: &World) -> Self {
        Self { last: *world.robot(), last_people: people(world) }
    }

    /// Steps the world and asserts: the robot's disc overlaps no cell that is not free and no
    /// person; speeds, accelerations and joints keep their limits; nobody jumps.
    pub(crate) fn step(&mut self, world: &mut World, command: Command) -> Vec<Event> {
        let events = world.step(command);
        let (now, last) = (*world.robot(), self.last);
        let model = world.settings().model;
        let step = world.settings().step.as_secs_f64();
        let map = &world.building().floors()[now.floor].map;
        assert!(map.disc_is_free(now.pose.position, model.radius), "touches a wall: {now:?}");
        for person in world.people().filter(|p| p.floor == now.floor) {
            let off = person.position.distance(now.pose.position);
            assert!(off >= model.radius + person.radius, "overlaps {}: {off} {now:?}", person.name);
        }
        let (v, w) = (now.twist.linear, now.twist.angular);
        assert!((0.0..=model.max_speed).contains(&v) && w.abs() <= model.max_turn, "{now:?}");
        let (left, right) = now.twist.rims(&model);
        assert!(left.abs().max(right.abs()) <= model.wheel_speed + ROUNDING, "{now:?}");
        assert!((v - last.twist.linear).abs() <= model.acceleration * step + ROUNDING, "{last:?} {now:?}");
        assert!(
            (w - last.twist.angular).abs() <= model.turn_acceleration * step + ROUNDING,
            "{last:?} {now:?}"
        );
        let changed = events.iter().any(|e| matches!(e, Event::FloorChanged { .. }));
        assert_eq!(changed, now.floor != last.floor);
        if !changed {
            let moved = now.pose.position.distance(last.pose.position);
            assert!(moved <= v * step + ROUNDING, "jumps: {last:?} {now:?}");
        }
        for (joint, limits) in [
            (now.joints.torso, model.torso),
            (now.joints.head_pan, model.head_pan),
            (now.joints.head_tilt, model.head_tilt),
        ] {
            assert!(joint.position >= limits.min - ROUNDING && joint.position <= limits.max + ROUNDING);
            assert!(joint.velocity.abs() <= limits.speed + ROUNDING);
        }
        let now_people = people(world);
        for (name, at) in &now_people {
            if let Some((_, before)) = self.last_people.iter().find(|(n, _)| n == name) {
                assert!(before.distance(*at) <= 3.0 * step + ROUNDING, "{name} jumps");
            }
        }
        if let Some(progress) = world.progress() {
            assert!((0.0..=1.0).contains(&progress.fraction));
            assert!(progress.remaining.distance.is_finite() && progress.remaining.seconds >= 0.0);
        }
        self.last = now;
        self.last_people = now_people;
        events
    }
}

fn people(world: &World) -> Vec<(String, Point)> {
    world.people().map(|p| (p.name.clone(), p.position)).collect()
}
