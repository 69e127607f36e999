//! The `.proto` files as Rust types and as descriptors.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use prost::Message as _;
use prost_types::FileDescriptorSet;

/// The packages as Protobuf nests them, so that one can name the other.
#[allow(missing_docs, clippy::all, clippy::pedantic, unreachable_pub, reason = "generated")]
mod selfneg {
    pub mod v1 {
        include!(concat!(env!("OUT_DIR"), "/selfneg.v1.rs"));
    }
    pub mod personal {
        pub mod v1 {
            include!(concat!(env!("OUT_DIR"), "/selfneg.personal.v1.rs"));
        }
    }
}

/// Package `selfneg.personal.v1`: what is personal of it.
#[doc(inline)]
pub use selfneg::personal::v1 as personal;
/// Package `selfneg.v1`: what happened, as far as it is nobody's personal data.
#[doc(inline)]
pub use selfneg::v1 as evidence;

/// Package `foxglove`: the part that we fill of what viewers know by name.
#[allow(missing_docs, clippy::all, clippy::pedantic, reason = "generated")]
pub mod foxglove {
    include!(concat!(env!("OUT_DIR"), "/foxglove.rs"));
}

const DESCRIPTORS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/descriptors.bin"));

/// Every message type that a topic has, by its full name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Schema {
    /// `selfneg.v1.Header`
    Header,
    /// `selfneg.v1.End`
    End,
    /// `selfneg.v1.Event`
    Event,
    /// `selfneg.v1.Record`
    Record,
    /// `selfneg.v1.Command`
    Command,
    /// `selfneg.v1.Sealed`
    Sealed,
    /// `selfneg.v1.Commitment`
    Commitment,
    /// `selfneg.personal.v1.Rules`
    Rules,
    /// `selfneg.personal.v1.Participant`
    Participant,
    /// `selfneg.personal.v1.Input`
    Input,
    /// `selfneg.personal.v1.Reply`
    Reply,
    /// `selfneg.personal.v1.Opening`
    Opening,
    /// `foxglove.FrameTransforms`
    FrameTransforms,
    /// `foxglove.Grid`
    Grid,
    /// `foxglove.Log`
    Log,
    /// `foxglove.PointCloud`
    PointCloud,
    /// `foxglove.PoseInFrame`
    PoseInFrame,
    /// `foxglove.SceneUpdate`
    SceneUpdate,
}

impl Schema {
    /// All of them.
    pub const ALL: [Self; 18] = [
        Self::Header,
        Self::End,
        Self::Event,
        Self::Record,
        Self::Command,
        Self::Sealed,
        Self::Commitment,
        Self::Rules,
        Self::Participant,
        Self::Input,
        Self::Reply,
        Self::Opening,
        Self::FrameTransforms,
        Self::Grid,
        Self::Log,
        Self::PointCloud,
        Self::PoseInFrame,
        Self::SceneUpdate,
    ];

    /// The one of this full name.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|schema| schema.name() == name)
    }

    /// The message's full name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Header => "selfneg.v1.Header",
            Self::End => "selfneg.v1.End",
            Self::Event => "selfneg.v1.Event",
            Self::Record => "selfneg.v1.Record",
            Self::Command => "selfneg.v1.Command",
            Self::Sealed => "selfneg.v1.Sealed",
            Self::Commitment => "selfneg.v1.Commitment",
            Self::Rules => "selfneg.personal.v1.Rules",
            Self::Participant => "selfneg.personal.v1.Participant",
            Self::Input => "selfneg.personal.v1.Input",
            Self::Reply => "selfneg.personal.v1.Reply",
            Self::Opening => "selfneg.personal.v1.Opening",
            Self::FrameTransforms => "foxglove.FrameTransforms",
            Self::Grid => "foxglove.Grid",
            Self::Log => "foxglove.Log",
            Self::PointCloud => "foxglove.PointCloud",
            Self::PoseInFrame => "foxglove.PoseInFrame",
            Self::SceneUpdate => "foxglove.SceneUpdate",
        }
    }

    const fn file(self) -> &'static str {
        match self {
            Self::Header | Self::End => "selfneg/v1/header.proto",
            Self::Event => "selfneg/v1/event.proto",
            Self::Record => "selfneg/v1/record.proto",
            Self::Command => "selfneg/v1/command.proto",
            Self::Sealed | Self::Commitment => "selfneg/v1/sealed.proto",
            Self::Rules | Self::Participant | Self::Input | Self::Reply | Self::Opening => {
                "selfneg/personal/v1/personal.proto"
            }
            Self::FrameTransforms => "foxglove/FrameTransforms.proto",
            Self::Grid => "foxglove/Grid.proto",
            Self::Log => "foxglove/Log.proto",
            Self::PointCloud => "foxglove/PointCloud.proto",
            Self::PoseInFrame => "foxglove/PoseInFrame.proto",
            Self::SceneUpdate => "foxglove/SceneUpdate.proto",
        }
    }

    /// The `FileDescriptorSet` of its file and of all that this imports, as MCAP wants it.
    /// Comments are left out.
    #[must_use]
    pub fn descriptors(self) -> &'static [u8] {
        static ALL: OnceLock<BTreeMap<Schema, Vec<u8>>> = OnceLock::new();
        let all = ALL.get_or_init(|| {
            // Made by the same build: it decodes, and the tests decode every answer again.
            let set = FileDescriptorSet::decode(DESCRIPTORS).unwrap_or_default();
            Self::ALL.into_iter().map(|schema| (schema, schema.files_of(&set).encode_to_vec())).collect()
        });
        all.get(&self).map(Vec::as_slice).unwrap_or_default()
    }

    fn files_of(self, all: &FileDescriptorSet) -> FileDescriptorSet {
        let mut wanted = BTreeSet::from([self.file().to_owned()]);
        // Files come after what they import, so that one pass from the end finds all.
        for file in all.file.iter().rev() {
            if wanted.contains(file.name()) {
                wanted.extend(file.dependency.iter().cloned());
            }
        }
        let file = all.file.iter().filter(|file| wanted.contains(file.name()));
        let file =
            file.map(|file| prost_types::FileDescriptorProto { source_code_info: None, ..file.clone() });
        FileDescriptorSet { file: file.collect() }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use prost::Message as _;
    use prost_types::FileDescriptorSet;

    use super::Schema;

    #[test]
    fn every_schema_is_in_its_descriptors_with_all_that_it_imports() {
        for schema in Schema::ALL {
            let set = FileDescriptorSet::decode(schema.descriptors()).unwrap();
            let (package, name) = schema.name().rsplit_once('.').unwrap();
            let holds = set.file.iter().any(|file| {
                file.package() == package && file.message_type.iter().any(|message| message.name() == name)
            });
            assert!(holds, "{}", schema.name());
            let mut before = BTreeSet::new();
            for file in &set.file {
                assert!(file.dependency.iter().all(|import| before.contains(import)), "{}", schema.name());
                before.insert(file.name().to_owned());
            }
        }
    }
}
