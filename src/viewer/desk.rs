//! The viewer's answers without a connection, for whoever tries very many requests.

use std::io;

use super::{
    page::Site,
    request::{Door, Token},
};

/// What answers requests, with a token of its own.
#[derive(Debug)]
pub struct Desk {
    door: Door,
}

impl Desk {
    /// One that serves a site as from a port.
    ///
    /// # Errors
    /// When the system gives no random numbers.
    pub fn new(site: Site, port: u16) -> io::Result<Self> {
        Ok(Self { door: Door { site, port, token: Token::new()? } })
    }

    /// How paths begin that are served; a slash follows.
    pub fn path(&self) -> String {
        self.door.token.path()
    }

    /// Head and content of the answer to what has arrived of a request; none when more must
    /// arrive.
    pub fn answer(&self, received: &[u8]) -> Option<Vec<u8>> {
        self.door.answer(received).map(|answer| answer.bytes())
    }
}
