//! A page: what a study has to say, put down once, shown as Markdown and as HTML.

use std::{collections::BTreeSet, fs, io::ErrorKind};

use maud::{Markup, html};

use super::*;
use super::{
    html::{document, figure_block, glue},
    table::in_markdown,
};
use crate::record::read_file;

/// A part of a page.
#[derive(Debug, Clone)]
pub(crate) enum Block {
    /// What it comes to, where there is nothing to warn of.
    Lead(String),
    /// What a reader must not miss.
    Banner(String),
    /// A paragraph.
    Text(String),
    /// A paragraph that explains.
    Soft(String),
    /// A heading within a section.
    Heading(String),
    /// Sentences one below the other.
    List(Vec<String>),
    Table(Table),
    /// A figure with its caption.
    Figure(Figure),
    /// What only HTML can show.
    Html(Markup),
}

impl Block {
    /// The lead, as a banner unless all is well.
    pub(crate) fn lead(text: String, is_well: bool) -> Self {
        if is_well { Self::Lead(text) } else { Self::Banner(text) }
    }

    fn is_empty(&self) -> bool {
        match self {
            Self::Lead(text) | Self::Banner(text) | Self::Text(text) | Self::Soft(text) => {
                text.is_empty()
            }
            Self::List(items) => items.is_empty(),
            Self::Table(table) => table.is_empty(),
            Self::Heading(_) | Self::Figure(_) | Self::Html(_) => false,
        }
    }

    fn markdown(&self) -> String {
        match self {
            Self::Lead(text) | Self::Text(text) | Self::Soft(text) => in_markdown(text),
            Self::Banner(text) => format!("**{}**", in_markdown(text)),
            Self::Heading(text) => format!("### {}", in_markdown(text)),
            Self::List(items) => {
                let items: Vec<String> =
                    items.iter().map(|item| format!("- {}", in_markdown(item))).collect();
                items.join("\n")
            }
            Self::Table(table) => table.markdown().trim_end().to_owned(),
            Self::Figure(Figure { title, stem, caption, .. }) => {
                format!("![{}](figures/{stem}.png)\n\n{}", in_markdown(title), in_markdown(caption))
            }
            Self::Html(_) => String::new(),
        }
    }

    fn html(&self) -> Markup {
        match self {
            Self::Lead(text) => html! { p.lead { (glue(text)) } },
            Self::Banner(text) => html! { p.banner { (glue(text)) } },
            Self::Text(text) => html! { p { (glue(text)) } },
            Self::Soft(text) => html! { p.soft { (glue(text)) } },
            Self::Heading(text) => html! { h3 { bdi { (glue(text)) } } },
            Self::List(items) => {
                html! { ul { @for item in items { li { bdi { (glue(item)) } } } } }
            }
            Self::Table(table) => table.html(),
            Self::Figure(figure) => figure_block(figure),
            Self::Html(markup) => markup.clone(),
        }
    }
}

#[derive(Debug, Clone)]
struct Section {
    id: String,
    title: String,
    blocks: Vec<Block>,
}

#[derive(Debug, Clone)]
pub(crate) struct Page {
    title: String,
    head: Vec<Block>,
    sections: Vec<Section>,
    has_contents: bool,
}

impl Page {
    pub(crate) fn new(title: impl Into<String>, head: impl IntoIterator<Item = Block>) -> Self {
        let head = without_empty(head);
        Self { title: title.into(), head, sections: Vec::new(), has_contents: false }
    }

    /// The page with another section; without it where nothing is in it.
    pub(crate) fn section(
        mut self,
        id: &str,
        title: &str,
        blocks: impl IntoIterator<Item = Block>,
    ) -> Self {
        let blocks = without_empty(blocks);
        if !blocks.is_empty() {
            self.sections.push(Section { id: id.to_owned(), title: title.to_owned(), blocks });
        }
        self
    }

    /// The page with a section of figures.
    pub(crate) fn figures(
        self,
        id: &str,
        title: &str,
        figures: impl IntoIterator<Item = Figure>,
    ) -> Self {
        self.section(id, title, figures.into_iter().map(Block::Figure))
    }

    /// The page with links to its sections after the first.
    pub(crate) fn with_contents(self) -> Self {
        Self { has_contents: true, ..self }
    }

    pub(crate) fn markdown(&self) -> String {
        let mut parts = vec![format!("# {}", in_markdown(&self.title))];
        parts.extend(self.head.iter().map(Block::markdown));
        for Section { title, blocks, .. } in &self.sections {
            parts.push(format!("## {}", in_markdown(title)));
            parts.extend(blocks.iter().map(Block::markdown));
        }
        parts.retain(|part| !part.is_empty());
        parts.join("\n\n") + "\n"
    }

    /// As HTML that needs nothing else.
    pub(crate) fn html(&self) -> String {
        let contents = || {
            html! {
                nav aria-label="Contents" { ul { @for section in &self.sections {
                    li { a href={ "#" (section.id) } { (section.title) } }
                } } }
            }
        };
        let body = html! {
            header {
                h1 { bdi { (plain(&self.title)) } }
                @for block in &self.head { (block.html()) }
            }
            main { @for (n, section) in self.sections.iter().enumerate() {
                section id=(section.id) {
                    h2 { (section.title) }
                    @for block in &section.blocks { (block.html()) }
                    @if n == 0 && self.has_contents { (contents()) }
                }
            } }
        };
        document(&self.title, &body)
    }

    /// Writes its figures into `figures/` of a folder, and the page itself under each name, in
    /// the form that the name's ending asks for. Figures that an earlier page of these names shows
    /// and this one does not are removed.
    pub(crate) fn write(&self, out: &Path, names: &[&str]) -> Result<(), ReportError> {
        let folder = out.join("figures");
        for block in self.sections.iter().flat_map(|section| &section.blocks) {
            if let Block::Figure(figure) = block {
                figure.write(&folder)?;
            }
        }
        let text = |name: &&str| if name.ends_with(".md") { self.markdown() } else { self.html() };
        let texts: Vec<String> = names.iter().map(text).collect();
        let own: BTreeSet<&str> = texts.iter().flat_map(|text| figures_in(text)).collect();
        for name in names {
            let Ok(earlier) = read_file(&out.join(name)) else { continue };
            let earlier = String::from_utf8_lossy(&earlier);
            figures_in(&earlier)
                .filter(|stem| !own.contains(stem))
                .try_for_each(|stem| remove_figure(&folder, stem))?;
        }
        for (name, text) in names.iter().zip(&texts) {
            write_file(&out.join(name), text.as_bytes())?;
        }
        Ok(())
    }
}

/// What the files of a figure end in.
const ENDINGS: [&str; 3] = ["svg", "png", "csv"];

/// The figures whose files in `figures/` a page names, without the ending.
fn figures_in(page: &str) -> impl Iterator<Item = &str> {
    let is_in_name = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    page.split("figures/").skip(1).filter_map(move |rest| {
        let end = rest.find(|c: char| !is_in_name(c)).unwrap_or(rest.len());
        let (stem, ending) = rest[..end].rsplit_once('.')?;
        ENDINGS.contains(&ending).then_some(stem)
    })
}

/// Removes the files of a figure, where they are there.
fn remove_figure(folder: &Path, stem: &str) -> Result<(), FileError> {
    ENDINGS.iter().try_for_each(|ending| {
        let path = folder.join(format!("{stem}.{ending}"));
        match fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                Err(FileError::new("remove", &path, error))
            }
            _ => Ok(()),
        }
    })
}

fn without_empty(blocks: impl IntoIterator<Item = Block>) -> Vec<Block> {
    blocks.into_iter().filter(|block| !block.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::table::table;

    /// Law: both forms say the same in the same order; what is empty leaves no section, and no
    /// name brings in a tag.
    #[test]
    fn a_page_says_the_same_in_both_forms() {
        let rows = table!([("<b>a", 1.5)], |(name, value)| {
            "name" => name,
            "value" => value,
        });
        let page = Page::new("Of <b>", [Block::lead("One run.".to_owned(), false)])
            .section("none", "Nothing", [Block::List(Vec::new())])
            .section("found", "Found", [Block::Table(rows), Block::Soft("5 mm".to_owned())])
            .section("notes", "Notes", [Block::List(vec!["first".into(), "second".into()])])
            .with_contents();
        assert_eq!(
            page.markdown(),
            "# Of &lt;b>\n\n**One run.**\n\n## Found\n\n| name | value |\n| --- | ---: |\n\
             | &lt;b>a | 1.5 |\n\n5 mm\n\n## Notes\n\n- first\n- second\n"
        );
        let html = page.html();
        let order = [
            "<title>Of &lt;b&gt;</title>",
            "<p class=\"banner\">One run.</p>",
            "<section id=\"found\"><h2>Found</h2>",
            "<bdi>&lt;b&gt;a</bdi>",
            "<p class=\"soft\">5\u{a0}mm</p>",
            "<nav aria-label=\"Contents\"><ul><li><a href=\"#found\">Found</a></li>",
            "<li><bdi>second</bdi></li>",
        ];
        let place = |piece: &str| html.find(piece).unwrap_or_else(|| panic!("{piece}: {html}"));
        assert!(order.map(place).is_sorted(), "law: in this order: {html}");
        assert!(!html.contains("Nothing"), "law: no section without content");
    }

    /// Law: of the figures of an earlier page those that the new one does not show go, and no other
    /// file does.
    #[test]
    fn figures_of_an_earlier_page_go_with_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path();
        let figure = |stem: &str| {
            let svg = r#"<svg xmlns="http://www.w3.org/2000/svg" width="1" height="1"/>"#;
            let words = stem.to_owned();
            Figure {
                stem: stem.to_owned(),
                title: words.clone(),
                caption: words,
                svg: svg.to_owned(),
                csv: b"a\n".to_vec(),
            }
        };
        let page = |stems: &[&str]| {
            let figures: Vec<Figure> = stems.iter().map(|stem| figure(stem)).collect();
            Page::new("Of", []).figures("figures", "Figures", figures)
        };
        for names in [&["report.html"][..], &["page.md"], &["page.md", "report.html"]] {
            page(&["effect-seed", "both"]).write(out, names).expect("written");
            fs::write(out.join("figures/mine.svg"), "").expect("written");
            page(&["both", "new"]).write(out, names).expect("written");
            let entries = fs::read_dir(out.join("figures")).expect("a folder").flatten();
            let mut got: Vec<String> =
                entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
            got.sort();
            let of = |stem: &str| ["csv", "png", "svg"].map(|ending| format!("{stem}.{ending}"));
            let expected = [&of("both")[..], &["mine.svg".to_owned()], &of("new")].concat();
            assert_eq!(
                got, expected,
                "law: of {names:?}, what is shown now and what is no figure's"
            );
        }
    }
}
