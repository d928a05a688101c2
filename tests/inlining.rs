//! Nothing of a kernel is left out of line: there it would be compiled without its instruction set and cost ten times
//! more, with correct results. This program disassembles itself and looks at every call that a kernel makes.
//!
//! It needs `objdump` and a build without debug assertions, whose checks of copied memory the compiler leaves out of
//! line: `cargo test --release --test inlining`.

use std::collections::HashMap;
use std::process::Command;

use specula::math::lanes::{IntLanes, Isa, Kernel, Lanes, Level, MaskLanes};

#[path = "../benches/lanes/shading.rs"]
mod shading;

use shading::Bounce;

/// Uses the functions over lanes that the shading pass does not.
struct Functions<'a>(&'a mut [f32]);

impl<S: Isa> Kernel<S> for Functions<'_> {
    type Output = bool;
    #[inline(always)]
    fn run(self, isa: S) -> bool {
        let x = isa.load(self.0);
        let (s, c) = x.sin_cos();
        let grown = x.exp() + x.exp_m1() + x.ln() + x.ln_1p() + x.powf(s);
        let turned = x.asin() + x.acos() + c.atan() + x.atan2(c).floor().round_ties_even();
        let bits = (grown + turned).to_bits().reverse_bits();
        let gathered = isa.gather_u32(&[1, 2, 3], bits & 3).to_unit();
        (gathered + turned.copysign(s).lerp(grown, c)).store(self.0);
        bits.signed_to_float().is_finite().all()
    }
}

/// What objdump prints about this program; nothing if there is no objdump.
fn objdump(arguments: &[&str]) -> Option<String> {
    let program = std::env::current_exe().ok()?;
    let output = Command::new("objdump").args(arguments).arg(program).output().ok()?;
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// One function of the program.
#[derive(Debug)]
struct Function {
    name: String,
    address: u64,
    lines: Vec<String>,
}

/// All functions, from lines like `00000000000814f0 <name>:` and the instructions that follow each.
fn functions(disassembly: &str) -> Vec<Function> {
    let mut functions: Vec<Function> = Vec::new();
    for line in disassembly.lines() {
        let head = line.strip_suffix(">:").and_then(|line| line.split_once(" <"));
        if let Some((address, name)) = head {
            let address = u64::from_str_radix(address, 16).expect("objdump begins functions with an address");
            functions.push(Function { name: name.to_owned(), address, lines: Vec::new() });
        } else if let Some(function) = functions.last_mut() {
            function.lines.push(line.to_owned());
        }
    }
    functions
}

/// Where the pointers of the offset table lead, from lines like `0000000000121c28 R_X86_64_RELATIVE *ABS*+0x1118a0`.
fn pointers(relocations: &str) -> HashMap<u64, String> {
    let pointer = |line: &str| {
        let mut words = line.split_whitespace();
        let slot = u64::from_str_radix(words.next()?, 16).ok()?;
        Some((slot, words.nth(1)?.to_owned()))
    };
    relocations.lines().filter_map(pointer).collect()
}

/// The name of what a line with a call calls.
fn callee(line: &str, functions: &[Function], pointers: &HashMap<u64, String>) -> String {
    let Some((_, slot)) = line.split_once("# ") else { return line.to_owned() };
    let slot = slot.split_whitespace().next().and_then(|slot| u64::from_str_radix(slot, 16).ok());
    let Some(target) = slot.and_then(|slot| pointers.get(&slot)) else { return line.to_owned() };
    let address = target.strip_prefix("*ABS*+0x").and_then(|address| u64::from_str_radix(address, 16).ok());
    let found = address.and_then(|address| functions.iter().find(|function| function.address == address));
    found.map_or_else(|| target.clone(), |function| function.name.clone())
}

#[test]
fn kernels_call_nothing_but_the_failures_of_bounds_checks() {
    if cfg!(debug_assertions) {
        println!("skipped: built with debug assertions");
        return;
    }
    let mut numbers = vec![0.5; 16];
    let from = shading::paths(64);
    for level in Level::available() {
        level.run(Functions(&mut numbers));
        level.run(Bounce { from: &from, to: &mut from.clone(), albedo: &[0.5] });
    }
    let disassembly = objdump(&["--disassemble", "--demangle", "--no-show-raw-insn"]);
    let (Some(disassembly), Some(relocations)) = (disassembly, objdump(&["--dynamic-reloc"])) else {
        println!("skipped: no objdump on this machine");
        return;
    };
    let (functions, pointers) = (functions(&disassembly), pointers(&relocations));
    let is_wide = |line: &&String| line.contains("%ymm") || line.contains("%zmm");
    let is_kernel = |function: &&Function| function.lines.iter().filter(is_wide).count() > 200;
    let kernels: Vec<_> = functions.iter().filter(is_kernel).collect();
    assert!(kernels.len() >= 4 || !cfg!(target_arch = "x86_64"), "only {} kernels found", kernels.len());
    for kernel in kernels {
        for line in kernel.lines.iter().filter(|line| line.contains("call ")) {
            let callee = callee(line, &functions, &pointers);
            let expected = ["slice_index", "panic", "copy_from_slice", "len_mismatch"];
            assert!(expected.iter().any(|name| callee.contains(name)), "{} calls {callee}", kernel.name);
        }
    }
}
