//! Nothing of a kernel is left out of line: there it would be compiled without its instruction set and cost ten times
//! more, with correct results. This program disassembles itself and looks at every call that a kernel makes: those of every lobe
//! as a path asks it and as a ray tree does, of lights, samplers, functions over lanes, and of a shading pass in one piece.
//!
//! It needs `objdump` and a build without debug assertions, whose checks of copied memory the compiler leaves out of
//! line: `cargo test --release --test inlining`.

use std::collections::HashMap;
use std::process::Command;

use specula::math::lanes::Level;

mod kernels;
#[path = "../support/lights.rs"]
mod lights;
#[path = "../support/one_of_each.rs"]
mod one_of_each;
#[path = "../../benches/lanes/shading.rs"]
mod shading;

use kernels::Functions;
use shading::Bounce;

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

/// Where a line with a call through a register goes: to what was loaded into it last.
fn callees(kernel: &Function, functions: &[Function], pointers: &HashMap<u64, String>) -> Vec<String> {
    let mut loaded: HashMap<&str, &str> = HashMap::new();
    let mut callees = Vec::new();
    for line in &kernel.lines {
        if let Some((_, register)) = line.split_once("call ").and_then(|(_, to)| to.trim().split_once('*')) {
            let from = if register.starts_with('%') { loaded.get(register.trim()) } else { None };
            callees.push(callee(from.unwrap_or(&line.as_str()), functions, pointers));
        } else if line.contains("call ") {
            callees.push(line.clone());
        } else if let Some((_, to)) = line.split_once("(%rip),").filter(|(mov, _)| mov.contains("mov ")) {
            loaded.insert(to.split_whitespace().next().unwrap_or(""), line);
        }
    }
    callees
}

/// What kernels may call: what tells of an index out of bounds and the like; whole numbers that are the same in all lanes; kernels
/// that are functions of their own; and rows of three and four, whose gathers are compiled for their instruction set wherever they end up.
const EXPECTED: [&str; 17] = [
    "slice_index",
    "panic",
    "copy_from_slice",
    "len_mismatch",
    "int_sqrt",
    "kernels::ask",
    "kernels::value",
    "kernels::shine",
    "kernels::pick",
    "kernels::numbers",
    "mapped::look_up",
    "environment_map::look_up",
    "environment_map::draw",
    "gather::eight_rows",
    "gather::sixteen_rows",
    "gather::eight_quads",
    "gather::sixteen_quads",
];

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
        assert!(!kernels::everything(level, &lights::lights()).is_nan(), "{}", level.name());
    }
    let disassembly = objdump(&["--disassemble", "--demangle", "--no-show-raw-insn"]);
    let (Some(disassembly), Some(relocations)) = (disassembly, objdump(&["--dynamic-reloc"])) else {
        println!("skipped: no objdump on this machine");
        return;
    };
    let (functions, pointers) = (functions(&disassembly), pointers(&relocations));
    let is_wide = |line: &&String| line.contains("%ymm") || line.contains("%zmm");
    let is_kernel = |function: &&Function| {
        // Entry points of an instruction set, however small; other functions of that size are such, too.
        let wide = function.lines.iter().filter(is_wide).count();
        wide > 200 || (wide > 0 && function.name.contains("vectorize"))
    };
    let kernels: Vec<_> = functions.iter().filter(is_kernel).collect();
    // Thirteen lobes, eleven of which have values besides, lights, samplers, functions, the shading pass, and what runs them all;
    // fewer by those that are too simple to be a function.
    let sets = Level::available().len() - 2;
    assert!(kernels.len() >= 25 * sets, "only {} kernels found for {sets} instruction sets", kernels.len());
    let mut failures = Vec::new();
    for kernel in kernels {
        for callee in callees(kernel, &functions, &pointers) {
            if !EXPECTED.iter().any(|name| callee.contains(name)) {
                failures.push(format!("{} calls {callee}", kernel.name));
            }
        }
    }
    failures.sort();
    failures.dedup();
    assert!(failures.is_empty(), "{} calls:\n{}", failures.len(), failures.join("\n"));
}
