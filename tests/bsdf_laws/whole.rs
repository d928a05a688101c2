//! Laws of whole surfaces: mirrored and refracted ways, glossy lobes and matt bases together, and mixes of surfaces.

use crate::lobes::{ANGLES, Lobe, Part, lobes, parts, surfaces, viewers};
use crate::one_of_each::{self, mixes};
use crate::random::Random;
use crate::{looseness, rounding};
use specula::bsdf::{self, Bsdf, Glass, Lobes, MOST_PARTS, Mix, RoughDielectric};
use specula::math::{Rgb, Vec3};

type V = Vec3<f32>;

/// The red light that a surface returns of light from all around.
fn albedo(name: &str, bsdf: Bsdf<f32>, wo: V) -> f64 {
    let branches = bsdf.branches(wo).into_iter().flatten().filter(|branch| branch.valid);
    let sharp: f64 = branches.map(|branch| f64::from(branch.weight.r)).sum();
    sharp + parts(name, bsdf).iter().map(|part| part.albedo(wo)).sum::<f64>()
}

#[test]
fn no_kind_is_missing() {
    assert_eq!(one_of_each::missing(&one_of_each::lobes()), [""; 0], "in the list of one of each");
    assert_eq!(one_of_each::missing(&surfaces()), [""; 0], "in the list that the laws run over");
    // Each is judged by its parts, by its branches, or by both.
    for (name, bsdf) in surfaces() {
        let is_sharp = bsdf.lobes().intersects(Lobes::SPECULAR);
        assert!(is_sharp || !parts(&name, bsdf).is_empty(), "{name} is not judged by any law");
    }
    let mixed: usize = mixes().iter().map(|(_, mix)| mix.parts().count()).sum();
    assert_eq!(mixed, one_of_each::lobes().len(), "all are in mixes");
}

/// What each reflects and lets through; metals of single bounces, and Schlick's surface, lose some.
#[test]
fn no_surface_makes_light() {
    for (name, bsdf) in surfaces() {
        let keeps_all = matches!(bsdf, Bsdf::Dielectric(_) | Bsdf::ThinDielectric(_) | Bsdf::Glazed(_));
        let keeps_all = keeps_all && !name.starts_with("one: ");
        for (angle, wo) in ANGLES.into_iter().zip(viewers()) {
            let albedo = albedo(&name, bsdf, wo);
            assert!(albedo < 1.002, "{name} at {angle} deg returns {albedo}");
            assert!(!keeps_all || albedo > 0.998, "{name} at {angle} deg returns {albedo}");
        }
    }
}

#[test]
fn surfaces_have_what_they_say() {
    let mut random = Random::new(11);
    for (name, bsdf) in surfaces() {
        let has = |lobes: Lobes| bsdf.lobes().intersects(lobes);
        let mut seen = [false; 4];
        for _ in 0..500 {
            let (wo, wi) = (random.upper(), random.direction());
            let sampled = bsdf.sample_glossy(wo, random.pair());
            let is_lit = |f: Rgb<f32>| !f.is_black();
            let glossy = is_lit(bsdf.eval_glossy(wo, wi)) || bsdf.pdf_glossy(wo, wi) > 0.0;
            let found = [
                is_lit(bsdf.eval_diffuse(wo, wi)),
                sampled[0].is_some() || (glossy && wi.z > 0.0),
                sampled[1].is_some() || (glossy && wi.z < 0.0),
                bsdf.branches(wo).iter().any(Option::is_some),
            ];
            for (seen, found) in seen.iter_mut().zip(found) {
                *seen |= found;
            }
        }
        let said = [Lobes::DIFFUSE, Lobes::GLOSSY, Lobes::THROUGH, Lobes::SPECULAR].map(has);
        // What is said may be black; what is not said may not be there.
        assert!(seen.iter().zip(said).all(|(seen, said)| said || !seen), "{name}: {seen:?}, said {said:?}");
        assert!(seen[1..] == said[1..], "{name}: {seen:?}, said {said:?}");
    }
}

#[test]
fn branches_are_mirrored_or_on_the_other_side_and_share_the_light() {
    let mut random = Random::new(12);
    let mut judged = 0;
    for (name, bsdf) in surfaces() {
        for _ in 0..2000 {
            let wo = random.upper();
            let [first, second] = bsdf.branches(wo);
            let mut sum = Rgb::BLACK;
            for branch in [first, second].into_iter().flatten().filter(|branch| branch.valid) {
                let off = (branch.wi.length2() - 1.0).abs();
                assert!(off < 1e-6, "{name} {wo:?}: {branch:?}");
                assert!(branch.radiance_scale > 0.0, "{name} {wo:?}: {branch:?}");
                let (mirrored, one) = (Vec3::new(-wo.x, -wo.y, wo.z), branch.radiance_scale.to_bits());
                let is_mirror = branch.wi == mirrored && one == 1.0_f32.to_bits();
                assert!(
                    if branch.transmission { branch.wi.z <= 0.0 } else { is_mirror },
                    "{name}: {branch:?}"
                );
                let Rgb { r, g, b } = branch.weight;
                assert!([r, g, b].iter().all(|x| (0.0..=1.0).contains(x)), "{name} {wo:?}: {branch:?}");
                sum += branch.weight;
                judged += 1;
            }
            assert!(sum.max_channel() <= 1.0 + 2e-7, "{name} {wo:?}: {first:?} and {second:?}");
            assert!(first.is_none_or(|branch| !branch.transmission), "{name}: reflection comes first");
            assert!(second.is_none_or(|branch| branch.transmission), "{name}: then transmission");
        }
    }
    assert!(judged > 50_000, "only {judged} branches");
}

/// Where light passes, view and light may be exchanged but for the square of the index that they are in.
#[test]
fn frost_is_reciprocal_but_for_the_square_of_the_index() {
    let mut random = Random::new(13);
    let turned = |w: V| Vec3::new(w.x, w.y, -w.z);
    let through = |lobe: &Lobe| lobe.part == Part::Below;
    let all = lobes();
    assert!(all.iter().filter(|lobe| through(lobe)).count() >= 24, "frost is in the list");
    for lobe in all.iter().filter(|lobe| through(lobe)) {
        let Bsdf::RoughDielectric(frost) = lobe.bsdf else { panic!("{}: frost of another kind", lobe.name) };
        let eta = frost.glass.eta();
        let back = Bsdf::RoughDielectric(RoughDielectric { glass: Glass::exact(1.0 / eta), ..frost });
        let mut lit = 0;
        for i in 0..4000 {
            let (wo, other) = (random.upper(), turned(random.upper()));
            // By turns of anywhere, and of the lobe, which may be narrow.
            let drawn = lobe.sample(wo, random.pair());
            let wi = if i % 2 == 0 && drawn.valid { drawn.wi } else { other };
            let there = lobe.eval(wo, wi).r;
            let again = back.eval_glossy(turned(wi), turned(wo)).r / (eta * eta);
            // On the way back it is the viewer's cosine that is the root of what is left near total reflection.
            let grazing = lobe.refracting(wo, wi).map_or(0.0, |[o, _]| 1e-6 / (o * o));
            let bound = rounding(lobe, wo, wi) + looseness(lobe, wo, wi) + grazing;
            assert!(
                (there - again).abs() <= bound * there.max(again) + 1e-6,
                "{} {wo:?} {wi:?}: {there} there, {again} back",
                lobe.name
            );
            lit += u32::from(there > 1e-3);
        }
        assert!(lit > 500, "{}: only {lit} of 4000 lit", lobe.name);
    }
}

#[test]
fn mixes_make_no_light_and_are_their_parts() {
    let mut random = Random::new(14);
    for (name, mix) in mixes() {
        for wo in [viewers()[1], viewers()[3]] {
            let sum: f64 = mix
                .parts()
                .map(|part: &bsdf::Part<f32>| f64::from(part.weight.r) * albedo(&name, part.bsdf, wo))
                .sum();
            assert!(sum > 0.05 && sum < 1.002, "{name} returns {sum}");
        }
        let all = mix.parts().fold(Lobes::NONE, |all, part| all | part.bsdf.lobes());
        assert_eq!(mix.lobes(), all, "{name}");
        for _ in 0..2000 {
            let (wo, wi) = (random.upper(), random.upper());
            let [there, back] = [mix.eval_diffuse(wo, wi), mix.eval_diffuse(wi, wo)];
            let sum =
                mix.parts().fold(Rgb::BLACK, |sum, part| sum + part.weight * part.bsdf.eval_diffuse(wo, wi));
            assert!(
                (there - sum).max_channel().abs() <= 1e-6 * sum.max_channel(),
                "{name}: {there:?} {sum:?}"
            );
            assert!(
                (there - back).max_channel().abs() <= 2e-5 * there.max_channel(),
                "{name}: {there:?} {back:?}"
            );
        }
    }
    let (_, bsdf) = one_of_each::lobes()[0];
    let mut mix = Mix::of(0.0_f32, bsdf);
    for _ in 0..MOST_PARTS {
        mix.push(bsdf::Part { weight: Rgb::WHITE, bsdf });
    }
    assert_eq!(mix.parts().count(), MOST_PARTS, "what there is no room for is left out");
}
