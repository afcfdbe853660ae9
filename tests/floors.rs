//! The floors of the house: every `use` line and every path in the sources is read, and one that leads up or across fails.
//! Code that only tests run may look anywhere.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use syn::visit::{self, Visit};
use syn::{Attribute, File, Item, ItemMod, ItemUse, UseTree};

/// The crates, the lowest first, and where their sources lie.
const CRATES: [(&str, &str); 4] = [
    ("firstbounce_core", "src/core"),
    ("firstbounce_capture", "src/capture"),
    ("firstbounce_lab", "src/lab"),
    ("firstbounce", "src"),
];

/// The floors of app, the lowest first. On one of them each file may import those below.
const FLOORS: [&str; 6] = ["base", "state", "views", "panels", "window", "launch"];

/// An import: which file asks for what, as segments from the name of the crate on.
#[derive(Debug)]
struct Import {
    file: String,
    from: Vec<String>,
    to: Vec<String>,
}

impl Import {
    fn rooms(&self) -> (&str, &str) {
        (self.from.get(1).map_or("", String::as_str), self.to.get(1).map_or("", String::as_str))
    }

    fn leads_to(&self, path: &[&str]) -> bool {
        self.to.iter().map(String::as_str).take(path.len()).eq(path.iter().copied())
    }

    fn comes_from(&self, path: &[&str]) -> bool {
        self.from.iter().map(String::as_str).take(path.len()).eq(path.iter().copied())
    }
}

impl std::fmt::Display for Import {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} imports {}", self.file, self.to.join("::"))
    }
}

/// Collects the imports of one file.
struct Reader {
    file: String,
    /// The module that is being read, from the name of the crate on.
    module: Vec<String>,
    imports: Vec<Import>,
}

impl Reader {
    /// Notes a path that leads out of its module; all others stay within it.
    fn note(&mut self, path: &[String]) {
        let Some(first) = path.first() else { return };
        let to = match first.as_str() {
            "crate" => [&self.module[..1], &path[1..]].concat(),
            "super" => {
                let ups = path.iter().take_while(|segment| *segment == "super").count();
                let Some(kept) = self.module.len().checked_sub(ups) else { return };
                [&self.module[..kept], &path[ups..]].concat()
            }
            name if CRATES.iter().any(|(of, _)| *of == name) => path.to_vec(),
            _ => return,
        };
        self.imports.push(Import { file: self.file.clone(), from: self.module.clone(), to });
    }

    fn note_tree(&mut self, before: &mut Vec<String>, tree: &UseTree) {
        match tree {
            UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.note_tree(before, &path.tree);
                before.pop();
            }
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.note_tree(before, tree)),
            UseTree::Name(syn::UseName { ident, .. }) | UseTree::Rename(syn::UseRename { ident, .. }) => {
                before.push(ident.to_string());
                self.note(before);
                before.pop();
            }
            UseTree::Glob(_) => self.note(before),
        }
    }

    /// Paths within a macro's words.
    fn note_tokens(&mut self, tokens: &str) {
        let words: Vec<_> = tokens.split_whitespace().collect();
        for start in 0..words.len() {
            let mut path = vec![words[start].to_owned()];
            let mut rest = &words[start + 1..];
            while let [colons, name, further @ ..] = rest
                && *colons == "::"
            {
                path.push((*name).to_owned());
                rest = further;
            }
            if path.len() > 1 {
                self.note(&path);
            }
        }
    }
}

impl<'ast> Visit<'ast> for Reader {
    fn visit_item(&mut self, item: &'ast Item) {
        let attributes = match item {
            Item::Mod(of) => &of.attrs,
            Item::Use(of) => &of.attrs,
            Item::Fn(of) => &of.attrs,
            Item::Impl(of) => &of.attrs,
            _ => &Vec::new(),
        };
        if !attributes.iter().any(is_for_tests) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        self.module.push(item.ident.to_string());
        visit::visit_item_mod(self, item);
        self.module.pop();
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        self.note_tree(&mut Vec::new(), &item.tree);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let segments: Vec<_> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        self.note(&segments);
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, of: &'ast syn::Macro) {
        self.note_tokens(&of.tokens.to_string());
        visit::visit_macro(self, of);
    }
}

fn is_for_tests(attribute: &Attribute) -> bool {
    attribute.path().is_ident("cfg") && attribute.parse_args::<syn::Path>().is_ok_and(|of| of.is_ident("test"))
}

/// Names of the modules that are declared for tests alone, and lie in files of their own.
fn modules_for_tests(file: &File) -> Vec<String> {
    let for_tests = |item: &Item| match item {
        Item::Mod(of) if of.attrs.iter().any(is_for_tests) => Some(of.ident.to_string()),
        _ => None,
    };
    file.items.iter().filter_map(for_tests).collect()
}

fn parse(path: &Path) -> File {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Every source file below a folder with its module, but for those of other crates, of tests and of benches.
fn sources(folder: &Path, module: &[String], found: &mut Vec<(PathBuf, Vec<String>)>) {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry of a folder").path()).collect();
    paths.sort();
    let here = ["lib.rs", "mod.rs"].iter().map(|name| folder.join(name)).find(|path| path.is_file());
    let left_out = here.as_deref().map(|path| modules_for_tests(&parse(path))).unwrap_or_default();
    for path in paths {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let is_of_tests = left_out.contains(&name) || ["tests", "benches", "examples"].contains(&name.as_str());
        if is_of_tests || path.join("Cargo.toml").is_file() {
            continue;
        }
        let inner = [module, std::slice::from_ref(&name)].concat();
        if path.is_dir() {
            sources(&path, &inner, found);
        } else if path.extension().is_some_and(|end| end == "rs") && name != "main" {
            let is_root = ["lib", "mod"].contains(&name.as_str());
            found.push((path, if is_root { module.to_vec() } else { inner }));
        }
    }
}

/// What the root of a crate gives on under its own name, and from which room.
fn given_on(root: &File) -> BTreeMap<String, Vec<String>> {
    fn walk(before: &[String], tree: &UseTree, found: &mut BTreeMap<String, Vec<String>>) {
        match tree {
            UseTree::Path(path) => walk(&[before, &[path.ident.to_string()]].concat(), &path.tree, found),
            UseTree::Group(group) => group.items.iter().for_each(|tree| walk(before, tree, found)),
            UseTree::Name(name) => {
                found.insert(name.ident.to_string(), before.to_vec());
            }
            UseTree::Rename(name) => {
                found.insert(name.rename.to_string(), before.to_vec());
            }
            UseTree::Glob(_) => {}
        }
    }
    let mut found = BTreeMap::new();
    for item in &root.items {
        if let Item::Use(of) = item {
            walk(&[], &of.tree, &mut found);
        }
    }
    found
}

/// Every import of every crate.
fn imports() -> Vec<Import> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut all = Vec::new();
    let mut given = BTreeMap::new();
    for (name, folder) in CRATES {
        given.insert(name, given_on(&parse(&root.join(folder).join("lib.rs"))));
        let mut files = Vec::new();
        sources(&root.join(folder), &[name.to_owned()], &mut files);
        assert!(files.len() > 5, "{name}: {} files", files.len());
        for (path, module) in files {
            let file = path.strip_prefix(root).unwrap_or(&path).display().to_string();
            let mut reader = Reader { file, module, imports: Vec::new() };
            reader.visit_file(&parse(&path));
            all.append(&mut reader.imports);
        }
    }
    // What the root gives on belongs to its room.
    for import in &mut all {
        let (Some(name), Some(first)) = (import.to.first(), import.to.get(1)) else { continue };
        if let Some(room) = given.get(name.as_str()).and_then(|given| given.get(first)) {
            let room = room.clone();
            import.to.splice(1..1, room);
        }
    }
    all
}

/// Fails with the rule and every import against it.
fn none_against(rule: &str, against: impl IntoIterator<Item = String>) {
    let lines: BTreeSet<_> = against.into_iter().collect();
    assert!(lines.is_empty(), "{rule}\n{}", lines.into_iter().collect::<Vec<_>>().join("\n"));
}

/// Rooms of a crate from which a way of imports leads back to themselves, each with the import that begins the way.
fn circles(of: &str, imports: &[Import]) -> Vec<String> {
    let mut ways: BTreeMap<&str, BTreeMap<&str, &Import>> = BTreeMap::new();
    for import in imports.iter().filter(|import| import.from[0] == of && import.to[0] == of) {
        let (from, to) = import.rooms();
        if !from.is_empty() && !to.is_empty() && from != to {
            ways.entry(from).or_default().entry(to).or_insert(import);
        }
    }
    let reaches = |from: &str, to: &str| {
        let (mut seen, mut next) = (BTreeSet::new(), vec![from]);
        while let Some(room) = next.pop() {
            if room == to {
                return true;
            }
            if seen.insert(room) {
                next.extend(ways.get(room).into_iter().flat_map(BTreeMap::keys).copied());
            }
        }
        false
    };
    let in_circle = |(from, to): (&str, &str)| reaches(to, from);
    let all = ways.iter().flat_map(|(from, to)| to.iter().map(move |(to, import)| ((*from, *to), import)));
    all.filter(|(way, _)| in_circle(*way)).map(|(_, import)| import.to_string()).collect()
}

#[test]
fn a_crate_imports_only_crates_below_it() {
    let height = |name: &String| CRATES.iter().position(|(of, _)| of == name);
    let upward = imports().into_iter().filter(|import| height(&import.to[0]) > height(&import.from[0]));
    none_against("core < capture < lab < the program", upward.map(|import| import.to_string()));
}

#[test]
fn the_rooms_of_a_crate_form_no_circle() {
    let imports = imports();
    for name in ["firstbounce_core", "firstbounce_capture", "firstbounce_lab"] {
        none_against("rooms of one crate do not import each other in a circle", circles(name, &imports));
    }
}

#[test]
fn graphics_know_neither_the_window_nor_the_command_line() {
    let above = [["firstbounce", "app"], ["firstbounce", "cli"]];
    let upward = imports()
        .into_iter()
        .filter(|import| import.comes_from(&["firstbounce", "gpu"]) && above.iter().any(|path| import.leads_to(path)));
    none_against("gpu imports nothing of app and of cli", upward.map(|import| import.to_string()));
}

#[test]
fn the_command_line_opens_the_window_by_one_door_and_the_window_knows_no_command_line() {
    const DOOR: [&str; 3] = ["run", "has_display", "Start"];
    let (app, cli) = (["firstbounce", "app"], ["firstbounce", "cli"]);
    let across = imports().into_iter().filter(|import| {
        let by_door = import.to.get(2).is_none_or(|name| DOOR.contains(&name.as_str()) || name == "self");
        (import.comes_from(&cli) && import.leads_to(&app) && !by_door)
            || (import.comes_from(&app) && import.leads_to(&cli))
    });
    none_against(
        "cli imports run, has_display and Start of app; app imports nothing of cli",
        across.map(|i| i.to_string()),
    );
}

#[test]
fn the_floors_of_the_window_import_only_those_below() {
    let height = |name: &str| FLOORS.iter().position(|floor| *floor == name);
    let upward = imports().into_iter().filter(|import| {
        let app = ["firstbounce", "app"];
        let (Some(from), Some(to)) = (import.from.get(2), import.to.get(2)) else { return false };
        let is_within = import.comes_from(&app) && import.leads_to(&app) && from != to;
        is_within
            && match (from.as_str(), to.as_str()) {
                ("widgets", to) => to != "base",
                (from, "widgets") => !["views", "panels", "window"].contains(&from),
                (from, to) => height(to) > height(from),
            }
    });
    none_against(
        "launch > window > panels > views > state > base; widgets import base alone, and window, panels and views import them",
        upward.map(|import| import.to_string()),
    );
}

#[test]
fn every_file_of_the_window_lies_on_a_floor() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/app");
    let entries = fs::read_dir(folder).expect("the folder of app");
    let names = entries
        .map(|entry| entry.expect("an entry").path().file_stem().expect("a name").to_string_lossy().into_owned());
    let beside = names.filter(|name| !FLOORS.contains(&name.as_str()) && !["mod", "widgets"].contains(&name.as_str()));
    none_against("app holds its floors, the widgets and mod.rs", beside);
}
