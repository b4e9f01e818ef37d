//! Runs every input of the fuzz corpus through its target once.

use std::fs;
use std::path::Path;

use gsk_tests::fuzz::TARGETS;

#[test]
fn every_kept_input_is_fine() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz-corpus");
    for target in &TARGETS {
        let folder = fs::read_dir(corpus.join(target.name)).expect("each target has a corpus");
        let mut inputs = 0;
        for entry in folder {
            let path = entry.expect("the folder can be read").path();
            println!("{}", path.display());
            (target.run)(&fs::read(path).expect("an input can be read"));
            inputs += 1;
        }
        assert!(inputs > 0, "{} has no inputs", target.name);
    }
}
