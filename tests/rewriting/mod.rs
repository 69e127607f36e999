//! A trace taken to pieces, and put together again after somebody has had a hand in it: with
//! right checksums and right MCAP records, so that only the evidence itself can tell.
#![allow(dead_code, reason = "each test uses a part")]

use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::records::{MessageHeader, Metadata};
use prost::Message as _;
use selfneg::trace::schema::evidence;
use selfneg::trace::{Message, Scan};

/// What a file holds.
#[derive(Clone)]
pub(crate) struct Pieces {
    pub(crate) messages: Vec<Message>,
    pub(crate) notes: Vec<(String, BTreeMap<String, String>)>,
}

impl Pieces {
    pub(crate) fn of(bytes: &[u8]) -> Self {
        let scan = Scan::of(bytes);
        assert_eq!(scan.damage, None);
        let notes = scan.notes.into_iter().map(|note| (note.name, note.entries)).collect();
        // Where a message stood in the file is no part of it.
        let messages = scan.messages.into_iter().map(|message| Message { at: 0, ..message }).collect();
        Self { messages, notes }
    }

    /// An MCAP file of them, the metadata first.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        self.with_chunks_of(1 << 20)
    }

    pub(crate) fn with_chunks_of(&self, bytes: u64) -> Vec<u8> {
        let options = mcap::WriteOptions::new().chunk_size(Some(bytes)).compression(None);
        let mut writer = options.create(Cursor::new(Vec::new())).unwrap();
        for (name, metadata) in &self.notes {
            writer.write_metadata(&Metadata { name: name.clone(), metadata: metadata.clone() }).unwrap();
        }
        let mut channels = BTreeMap::new();
        for message in &self.messages {
            let channel = &message.channel;
            let channel_id = *channels.entry(channel.digest).or_insert_with(|| {
                let schema = match &*channel.schema {
                    "" => 0,
                    name => writer.add_schema(name, &channel.schema_encoding, &channel.schema_data).unwrap(),
                };
                writer.add_channel(schema, &channel.topic, &channel.encoding, &channel.metadata).unwrap()
            });
            let Message { sequence, log_time, publish_time, .. } = *message;
            let header = MessageHeader { channel_id, sequence, log_time, publish_time };
            writer.write_to_known_channel(&header, &message.data).unwrap();
        }
        writer.finish().unwrap();
        writer.into_inner().into_inner()
    }

    /// Numbers the messages anew, and what is in them: the places of events and replies, and
    /// what the end counts. Of a plain trace.
    pub(crate) fn renumber(&mut self) {
        let (mut index, mut events, mut decisions) = (0, 0, 0);
        let mut now = BTreeMap::new();
        for (sequence, message) in (0..).zip(&mut self.messages) {
            message.sequence = sequence;
            match &*message.schema {
                "selfneg.v1.Event" => {
                    let mut event = evidence::Event::decode(message.data.as_slice()).unwrap();
                    now.insert(event.index, index);
                    event.index = index;
                    index += 1;
                    events += 1;
                    message.data = event.encode_to_vec();
                }
                "selfneg.v1.Record" => {
                    let mut record = evidence::Record::decode(message.data.as_slice()).unwrap();
                    use evidence::record::Record::{Decided, EmergencyDecided};
                    decisions += u64::from(matches!(record.record, Some(Decided(_) | EmergencyDecided(_))));
                    now.insert(record.index, index);
                    record.index = index;
                    index += 1;
                    message.data = record.encode_to_vec();
                }
                "selfneg.v1.Command" => {
                    let mut command = evidence::Command::decode(message.data.as_slice()).unwrap();
                    now.insert(command.index, index);
                    command.index = index;
                    index += 1;
                    message.data = command.encode_to_vec();
                }
                "selfneg.personal.v1.Input" => {
                    use selfneg::trace::schema::personal::Input;
                    let mut input = Input::decode(message.data.as_slice()).unwrap();
                    input.index = now[&input.index];
                    message.data = input.encode_to_vec();
                }
                "selfneg.personal.v1.Reply" => {
                    use selfneg::trace::schema::personal::Reply;
                    let mut reply = Reply::decode(message.data.as_slice()).unwrap();
                    reply.index = now[&reply.index];
                    message.data = reply.encode_to_vec();
                }
                "selfneg.v1.End" => {
                    let end = evidence::End {
                        events,
                        replies: index - events,
                        decisions,
                        messages: u64::from(sequence),
                    };
                    message.data = end.encode_to_vec();
                }
                _ => {}
            }
        }
    }

    /// Changes the first record for which `change` says that it has changed it.
    pub(crate) fn change_record(&mut self, mut change: impl FnMut(&mut evidence::record::Record) -> bool) {
        for message in &mut self.messages {
            if &*message.schema != "selfneg.v1.Record" {
                continue;
            }
            let mut record = evidence::Record::decode(message.data.as_slice()).unwrap();
            if record.record.as_mut().is_some_and(&mut change) {
                message.data = record.encode_to_vec();
                return;
            }
        }
        panic!("there is no such record");
    }

    /// Of how many records this is true.
    pub(crate) fn count(&self, is: impl Fn(&evidence::record::Record) -> bool) -> usize {
        let records = self.messages.iter().filter(|message| &*message.schema == "selfneg.v1.Record");
        let records = records.filter_map(|message| evidence::Record::decode(message.data.as_slice()).ok());
        records.filter(|record| record.record.as_ref().is_some_and(&is)).count()
    }

    /// Takes out the first record of which this is true, with its personal part.
    pub(crate) fn take_out(&mut self, mut is: impl FnMut(&evidence::record::Record) -> bool) {
        let place = self.messages.iter().position(|message| {
            &*message.schema == "selfneg.v1.Record"
                && evidence::Record::decode(message.data.as_slice())
                    .unwrap()
                    .record
                    .is_some_and(|record| is(&record))
        });
        let place = place.expect("there is no such record");
        self.messages.remove(place);
        while self.messages.get(place).is_some_and(|next| &*next.schema == "selfneg.personal.v1.Reply") {
            self.messages.remove(place);
        }
        self.renumber();
    }
}
