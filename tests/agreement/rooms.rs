//! Rooms by other renderers: a Cornell box by Tungsten closely, a staircase loosely.

use crate::data_folder::folder;
use crate::mitsuba::Peer;
use crate::scene::scene_of;
use crate::shots::{Shot, Verdict};
use crate::table::{HEAD, row, samples, tell};

#[test]
fn the_box_is_that_of_tungsten() {
    let Some(folder) = folder("scenes/cornell-box") else { return };
    let peer = Peer::read(&folder.join("scene.xml"), 0);
    let spp = samples(32);
    let settings = format!("integrator = \"path\"\nsampler = \"independent\"\nspp = {spp}");
    let found = Shot::of(&scene_of(&peer.scene(&settings, [256, 256])));
    let reference = Shot::read(&folder.join("TungstenRender.exr"), None).blocks(4);
    let [found, reference] = [found, reference].map(|shot| shot.blocks(16));
    // Without the lamp and its edges.
    let dropped: Vec<bool> = reference.mean.iter().map(|pixel| pixel[0] > 1.5).collect();
    let verdict = Verdict::of(&found.without(&dropped), &reference.without(&dropped));
    let table =
        HEAD.to_owned() + &row("cornell-box", spp, &verdict, "blocks of 64 by 64 pixels of the reference");
    tell("Boxes", &table);
    assert!(verdict.bias.abs() < 3e-3, "{verdict:?}");
}
