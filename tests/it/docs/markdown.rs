//! As much of Markdown as the checks of the documents need.

/// Lines of a text, each with the language of the fenced block it is inside
/// of; an empty line outside stands for each fence.
fn lines(text: &str) -> Vec<(&str, Option<&str>)> {
    let mut language = None;
    let mut found = Vec::new();
    for line in text.lines() {
        match (line.trim_start().strip_prefix("```"), language) {
            (Some(name), outside) => {
                language = if outside.is_none() { Some(name.trim()) } else { None };
                found.push(("", None));
            }
            (None, _) => found.push((line, language)),
        }
    }
    found
}

/// Contents of the fenced blocks of a language.
pub fn blocks(text: &str, language: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut inside = false;
    for (line, block) in lines(text) {
        if block != Some(language) {
            inside = false;
            continue;
        }
        if !inside {
            found.push(String::new());
        }
        inside = true;
        if let Some(content) = found.last_mut() {
            content.push_str(line);
            content.push('\n');
        }
    }
    found
}

/// Inline code, outside of fenced blocks, also where it goes on on the next line.
pub fn spans(text: &str) -> Vec<String> {
    let outside = lines(text).into_iter();
    let outside = outside.map(|(line, block)| if block.is_none() { line.trim() } else { "" });
    let outside: Vec<&str> = outside.collect();
    let mut found = Vec::new();
    for paragraph in outside.join("\n").split("\n\n") {
        let code = paragraph.split('`').skip(1).step_by(2);
        found.extend(code.map(|code| code.replace('\n', " ")));
    }
    found
}

/// Targets of inline links, outside of fenced blocks.
pub fn links(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (line, _) in lines(text).into_iter().filter(|(_, block)| block.is_none()) {
        let mut rest = line;
        while let Some((_, after)) = rest.split_once("](") {
            let Some((target, after)) = after.split_once(')') else { break };
            found.push(target.to_owned());
            rest = after;
        }
    }
    found
}

/// Names under which a text's headings can be linked to, as GitHub makes them.
pub fn anchors(text: &str) -> Vec<String> {
    lines(text)
        .into_iter()
        .filter(|(line, block)| block.is_none() && line.starts_with('#'))
        .map(|(line, _)| {
            line.trim_start_matches('#')
                .trim()
                .to_lowercase()
                .chars()
                .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'))
                .map(|c| if c == ' ' { '-' } else { c })
                .collect()
        })
        .collect()
}

/// Targets of every `make` command in inline code and in shell blocks.
pub fn make_targets(text: &str) -> Vec<String> {
    let mut commands: Vec<String> = Vec::new();
    for (line, block) in lines(text) {
        match block {
            Some("sh") => commands.push(line.split('#').next().unwrap_or_default().to_owned()),
            Some(_) => {}
            None => commands.extend(line.split('`').skip(1).step_by(2).map(str::to_owned)),
        }
    }
    commands
        .iter()
        .flat_map(|commands| commands.split("&&"))
        .filter_map(|command| command.trim().strip_prefix("make "))
        // What stands in quotes is a value.
        .map(|words| words.split('"').step_by(2).collect::<String>())
        .flat_map(|words| words.split_whitespace().map(str::to_owned).collect::<Vec<_>>())
        .filter(|word| !word.contains('=') && !word.starts_with(['[', '-']))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# A `b` c\n[x](y.md) and [z](w)\n```sh\nmake one A=\"b\" # make two\n```\n\
                        `make three` `cmake four`\n  ```json\n{}\n  ```\n```json\n[](n)\n```\n";

    #[test]
    fn parts_are_found() {
        assert_eq!(links(TEXT), ["y.md", "w"]);
        assert_eq!(anchors(TEXT), ["a-b-c"]);
        assert_eq!(make_targets(TEXT), ["one", "three"]);
        assert_eq!(blocks(TEXT, "json"), ["{}\n", "[](n)\n"]);
        assert!(blocks(TEXT, "yaml").is_empty());
        assert_eq!(spans(TEXT), ["b", "make three", "cmake four"]);
        assert_eq!(spans("`a\n b` c\n\n`d\n\ne` `f"), ["a b", "d", " "]);
    }
}
