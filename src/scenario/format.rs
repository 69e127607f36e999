//! The TOML file as it stands, before names are looked up and ranges are checked.

use std::path::PathBuf;

use indexmap::IndexMap;
use serde::Deserialize;

use crate::mission::{Evidence, Specification};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct ScenarioFile {
    pub(super) name: String,
    #[serde(default)]
    pub(super) about: String,
    pub(super) building: String,
    pub(super) start: String,
    pub(super) rules: PathBuf,
    #[serde(default = "half_an_hour")]
    pub(super) until: f64,
    #[serde(default = "round_seconds")]
    pub(super) round_seconds: f64,
    #[serde(default)]
    pub(super) protocol: ProtocolFile,
    #[serde(default)]
    pub(super) mission: Specification,
    #[serde(default)]
    pub(super) actions: IndexMap<String, ActionFile>,
    #[serde(default)]
    pub(super) users: Vec<UserFile>,
    #[serde(default)]
    pub(super) people: Vec<BystanderFile>,
    #[serde(default)]
    pub(super) requests: Vec<RequestFile>,
    #[serde(default)]
    pub(super) updates: Vec<UpdateFile>,
    #[serde(default)]
    pub(super) withdrawals: Vec<WithdrawalFile>,
    #[serde(default)]
    pub(super) emergencies: Vec<EmergencyFile>,
    pub(super) shutdown: Option<WhenFile>,
}

fn half_an_hour() -> f64 {
    1800.0
}

fn round_seconds() -> f64 {
    0.2
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct ProtocolFile {
    pub(super) quit: Option<String>,
    pub(super) aggregation: Option<String>,
    pub(super) tie: Option<String>,
    pub(super) fallback: Option<String>,
    #[serde(default)]
    pub(super) willingness: u8,
    pub(super) policy: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) enum ActionFile {
    Meet,
    Drive(String),
    Guide(String),
    Wait(f64),
    Say(String),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct UserFile {
    pub(super) name: Option<String>,
    pub(super) folder: Option<PathBuf>,
    pub(super) profiles: Option<IndexMap<String, IndexMap<String, u8>>>,
    pub(super) status: Option<IndexMap<String, toml::Value>>,
    pub(super) context: Option<IndexMap<String, String>>,
    pub(super) answers_after: Option<toml::Value>,
    pub(super) stands: Option<SpotFile>,
    #[serde(default)]
    pub(super) walks: Vec<WaypointFile>,
    #[serde(default)]
    pub(super) leaves: bool,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct BystanderFile {
    pub(super) name: String,
    pub(super) stands: SpotFile,
    #[serde(default)]
    pub(super) walks: Vec<WaypointFile>,
    #[serde(default)]
    pub(super) repeat: bool,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct SpotFile {
    pub(super) floor: Option<String>,
    pub(super) x: f64,
    pub(super) y: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct WaypointFile {
    pub(super) x: f64,
    pub(super) y: f64,
    #[serde(default)]
    pub(super) wait: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct WhenFile {
    pub(super) at: Option<f64>,
    pub(super) near: Option<String>,
    pub(super) within: Option<f64>,
    pub(super) reaching: Option<String>,
    pub(super) later: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct RequestFile {
    pub(super) user: String,
    pub(super) goal: Option<String>,
    pub(super) meet: String,
    pub(super) when: WhenFile,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct UpdateFile {
    pub(super) user: String,
    #[serde(default)]
    pub(super) status: IndexMap<String, toml::Value>,
    #[serde(default)]
    pub(super) context: IndexMap<String, String>,
    pub(super) when: WhenFile,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct WithdrawalFile {
    pub(super) user: String,
    pub(super) when: WhenFile,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct EmergencyFile {
    pub(super) category: String,
    pub(super) place: String,
    pub(super) evidence: Evidence,
    pub(super) when: WhenFile,
}
