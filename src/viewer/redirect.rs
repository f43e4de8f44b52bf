//! How a browser gets an address that nobody else may see: in a file that its owner alone can
//! read. What programs are started with, every user of the machine can list.

use std::{
    io::{self, Write},
    path::Path,
};

use tempfile::{NamedTempFile, TempDir};

const NAME: &str = "pluvia-view.html";

/// A page on the disk that leads to an address; it is removed when this is dropped.
#[derive(Debug)]
pub struct Redirect {
    file: NamedTempFile,
    _folder: TempDir,
}

impl Redirect {
    /// Writes the page into a new folder of the system's for temporary files. Folder and file are
    /// for their owner alone.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn to(url: &str) -> io::Result<Self> {
        let mut builder = tempfile::Builder::new();
        builder.prefix("pluvia-view-");
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700));
        let folder = builder.tempdir()?;
        // For its owner alone from the moment it is there.
        let mut file = tempfile::Builder::new().prefix(NAME).rand_bytes(0).tempfile_in(&folder)?;
        // The address is of our own making: letters, digits, and `:/.`.
        writeln!(
            file,
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <title>Pluvia</title>\n<meta name=\"referrer\" content=\"no-referrer\">\n\
             <meta http-equiv=\"refresh\" content=\"0; url={url}\">\n</head>\n\
             <body><a href=\"{url}\">The run</a></body>\n</html>"
        )?;
        file.flush()?;
        Ok(Self { file, _folder: folder })
    }

    /// The page.
    pub fn path(&self) -> &Path {
        self.file.path()
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn the_page_leads_to_the_address_is_private_and_goes() {
        let redirect = Redirect::to("http://127.0.0.1:1/0123/").expect("written");
        let path = redirect.path().to_owned();
        let page = fs::read_to_string(&path).expect("a page");
        assert!(page.contains("url=http://127.0.0.1:1/0123/\""), "law: it leads there: {page}");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let mode =
                |path: &Path| fs::metadata(path).expect("there").permissions().mode() & 0o777;
            assert_eq!(mode(&path), 0o600, "law: nobody else reads it");
            let folder = path.parent().expect("a folder");
            assert_eq!(mode(folder), 0o700, "law: nobody else lists its folder");
        }
        drop(redirect);
        assert!(!path.exists() && !path.parent().is_some_and(Path::exists), "law: nothing stays");
    }
}
