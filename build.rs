//! Makes Rust types and descriptors from the trace's `.proto` files, without `protoc`.

use std::error::Error;
use std::path::PathBuf;
use std::{env, fs};

use prost::Message as _;

const FILES: &[&str] = &[
    "foxglove/FrameTransforms.proto",
    "foxglove/Grid.proto",
    "foxglove/Log.proto",
    "foxglove/PointCloud.proto",
    "foxglove/PoseInFrame.proto",
    "foxglove/SceneUpdate.proto",
    "selfneg/personal/v1/personal.proto",
    "selfneg/v1/command.proto",
    "selfneg/v1/event.proto",
    "selfneg/v1/header.proto",
    "selfneg/v1/record.proto",
    "selfneg/v1/sealed.proto",
];

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=proto");
    let descriptors =
        protox::Compiler::new(["proto"])?.include_imports(true).open_files(FILES)?.file_descriptor_set();
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("OUT_DIR is not set")?);
    fs::write(out.join("descriptors.bin"), descriptors.encode_to_vec())?;
    prost_build::Config::new().compile_fds(descriptors)?;
    Ok(())
}
