//! The paper's mall as a script: Alice is being led to the bathroom, Bob interrupts for the
//! pharmacy, and Carla is only passing by.

use std::collections::VecDeque;
use std::error::Error;

use selfneg::demo;
use selfneg::mission::{
    Category, CategoryId, Command, Event, Evidence, ExecutionId, Goal, GoalId, Inference, Mission,
    MissionRules, Output, Place, Proof, Record, Specification, Task, UserId,
};
use selfneg::run::{Participant, Setup, Watcher};
use selfneg_core::Options;
use selfneg_sim::{Activity, Building, Command as Drive, Person, Point, Settings, World};

const ALICE: UserId = UserId(1);
const BOB: UserId = UserId(2);

/// Alice and Bob, as users of the run.
pub fn participants() -> Result<Vec<Participant>, Box<dyn Error>> {
    let one =
        |pseudonym, user: selfneg::input::User| Participant { pseudonym, person: user.name.clone(), user };
    Ok(vec![one(ALICE, demo::alice()?), one(BOB, demo::bob()?)])
}

/// Goals of two tasks, one kind of emergency, one inference.
pub fn specification() -> Specification {
    let task =
        |name: &str| Task { name: name.to_owned(), actions: vec!["drive".to_owned()], interruptible: true };
    let goal = |name: &str| Goal {
        name: name.to_owned(),
        needs: vec!["drive".to_owned()],
        tasks: vec![task("meet"), task("lead")],
        ..Goal::default()
    };
    Specification {
        capabilities: vec!["drive".to_owned()],
        goals: vec![goal("bathroom"), goal("pharmacy")],
        emergencies: vec![Category {
            name: "fall".to_owned(),
            gravity: 5,
            proof: Proof::Sensed,
            goal: "pharmacy".to_owned(),
        }],
        inferences: vec![Inference {
            attribute: "crowd".to_owned(),
            value: "dense".to_owned(),
            condition: "crowd anxiety".to_owned(),
        }],
        ..Specification::default()
    }
}

/// Plays the script before `watcher`, and gives the mission's replies.
pub fn play(watcher: &mut dyn Watcher) -> Result<Vec<Output>, Box<dyn Error>> {
    let building = Building::mall()?;
    let (rules, specification, participants) = (demo::rules()?, specification(), participants()?);
    let places = ["information", "flowers", "bathroom", "pharmacy"].map(str::to_owned);
    let (options, policy) = (Options::default(), None);
    watcher.begin(&Setup {
        name: "scripted",
        building: &building,
        rules: &rules,
        specification: &specification,
        options,
        policy,
        participants: &participants,
        places: &places,
    })?;
    let mut world = World::new(building, Settings::default(), "charging station")?;
    world.add_person(Person::standing("Alice", 0, Point::new(12.0, 6.0)))?;
    world.add_person(Person::standing("Bob", 0, Point::new(14.0, 6.5)))?;
    world
        .add_person(Person::standing("Carla", 0, Point::new(16.0, 6.0)).walking(&[Point::new(19.0, 6.4)]))?;
    watcher.world(world.time(), &world)?;

    let rules = MissionRules::new(&rules, specification, options, policy)?;
    let (mission, first) = Mission::new(rules);
    let mut play = Play {
        watcher,
        world,
        mission,
        all: Vec::new(),
        events: VecDeque::new(),
        execution: None,
        places: &places,
        participants: &participants,
    };
    play.replies(first)?;
    play.handle(Event::Request { user: ALICE, goal: GoalId(0), place: Place(0) })?;
    play.drive(200)?;
    play.handle(Event::Status {
        user: ALICE,
        condition: "elderly".into(),
        truth: selfneg::input::Truth::Withheld,
    })?;
    play.handle(Event::Request { user: BOB, goal: GoalId(1), place: Place(1) })?;
    play.handle(Event::Context { user: BOB, attribute: "crowd".into(), value: "dense".into() })?;
    let claim = |evidence| Event::Emergency { category: CategoryId(0), place: Place(3), evidence };
    play.handle(claim(Evidence::Claimed))?;
    play.drive(20_000)?;
    play.handle(claim(Evidence::Sensed))?;
    play.drive(100)?;
    play.handle(Event::Withdraw { user: BOB })?;
    play.handle(Event::DataTimeout { user: BOB, ask: selfneg::mission::AskId(99) })?;
    play.drive(20_000)?;
    play.handle(Event::Shutdown)?;
    play.drive(1)?;
    let at = play.world.time();
    let all = play.all;
    watcher.end(at)?;
    Ok(all)
}

struct Play<'p> {
    watcher: &'p mut dyn Watcher,
    world: World,
    mission: Mission,
    all: Vec<Output>,
    events: VecDeque<Event>,
    execution: Option<ExecutionId>,
    places: &'p [String],
    participants: &'p [Participant],
}

impl Play<'_> {
    /// Handles an event, and all that its replies bring about at once.
    fn handle(&mut self, event: Event) -> Result<(), Box<dyn Error>> {
        self.events.push_back(event);
        while let Some(event) = self.events.pop_front() {
            self.watcher.event(self.world.time(), &event)?;
            let outputs = self.mission.handle(event);
            self.replies(outputs)?;
        }
        Ok(())
    }

    fn replies(&mut self, outputs: Vec<Output>) -> Result<(), Box<dyn Error>> {
        let at = self.world.time();
        let mut decided = false;
        for output in outputs {
            self.watcher.output(at, &output)?;
            match &output {
                Output::Command(command) => self.obey(*command)?,
                Output::Record(Record::Decided { served, .. }) => {
                    let name = self.participants.iter().find(|one| one.pseudonym == *served);
                    let name = name.map_or("somebody", |one| one.person.as_str());
                    self.watcher.sentence(at, &format!("{name} has precedence."))?;
                    decided = true;
                }
                Output::Record(_) => {}
            }
            self.all.push(output);
        }
        self.watcher.world(at, &self.world)?;
        if decided {
            self.watcher.decided(at)?;
        }
        Ok(())
    }

    fn obey(&mut self, command: Command) -> Result<(), Box<dyn Error>> {
        match command {
            Command::AskData { user, ask, .. } => {
                let data = self.participants.iter().find(|one| one.pseudonym == user);
                let data = data.map(|one| (&one.user).into()).unwrap_or_default();
                self.events.push_back(Event::Data { user, ask, data });
            }
            Command::NextRound => self.events.push_back(Event::NextRound),
            Command::Execute { execution, goal, task, place, .. } => {
                let lead = if goal == GoalId(0) { "bathroom" } else { "pharmacy" };
                let meet = usize::try_from(place.0).ok().and_then(|place| self.places.get(place));
                let to = if task == 0 { meet.map_or(lead, String::as_str) } else { lead };
                self.execution = Some(execution);
                let _told = self.world.step(Drive::go_to(to));
            }
            Command::Stop { .. } => {
                self.execution = None;
                let _told = self.world.step(Drive::Cancel);
            }
            _ => {}
        }
        Ok(())
    }

    /// Lets the robot drive for so many steps at most, or until it has nothing to do.
    fn drive(&mut self, steps: u32) -> Result<(), Box<dyn Error>> {
        for step in 0..steps {
            if self.world.activity() == Activity::Idle {
                match self.execution.take() {
                    Some(execution) => self.handle(Event::ActionDone { execution })?,
                    None => break,
                }
            }
            let _told = self.world.step(Drive::Continue);
            if step % 10 == 0 {
                self.watcher.world(self.world.time(), &self.world)?;
            }
        }
        Ok(())
    }
}
