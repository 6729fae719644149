//! One sender at a time, over TCP on this machine or a pseudo terminal.
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};

/// The connection for a sender.
pub enum Wire {
    /// TCP.
    Tcp {
        /// Waits for senders.
        listener: TcpListener,
        /// The connected sender.
        sender: Option<TcpStream>,
        /// Whether a sender was connected and has left.
        has_gone: bool,
    },
    /// A pseudo terminal.
    #[cfg(unix)]
    Pty(pty::Pty),
}

impl Wire {
    /// Listens on a port of this machine; 0: any free one.
    ///
    /// # Errors
    /// The port is taken.
    pub fn tcp(port: u16) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        Ok(Self::Tcp { listener, sender: None, has_gone: false })
    }

    /// A new pseudo terminal in raw mode.
    ///
    /// # Errors
    /// The system has none.
    #[cfg(unix)]
    pub fn pty() -> io::Result<Self> {
        Ok(Self::Pty(pty::Pty::new()?))
    }

    /// The text that a sender needs for its connection.
    ///
    /// # Errors
    /// The system does not know it.
    pub fn name(&self) -> io::Result<String> {
        match self {
            Self::Tcp { listener, .. } => Ok(format!("tcp {}", listener.local_addr()?)),
            #[cfg(unix)]
            Self::Pty(pty) => Ok(format!("pty {}", pty.name)),
        }
    }

    /// Whether a sender was connected and has left.
    pub fn has_gone(&self) -> bool {
        match self {
            Self::Tcp { has_gone, .. } => *has_gone,
            #[cfg(unix)]
            Self::Pty(_) => false,
        }
    }

    /// Accepts senders. A second sender gets a message and is disconnected.
    fn accept(&mut self) -> io::Result<()> {
        let Self::Tcp { listener, sender, .. } = self else { return Ok(()) };
        match listener.accept() {
            Ok((mut stream, _)) if sender.is_some() => {
                // The client may have left already.
                let _ = stream.write_all(b"[MSG:another sender is connected]\r\n");
            }
            Ok((stream, _)) => {
                stream.set_nodelay(true)?;
                stream.set_nonblocking(true)?;
                *sender = Some(stream);
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => return Err(error),
        }
        Ok(())
    }

    fn lose(&mut self) {
        if let Self::Tcp { sender, has_gone, .. } = self {
            (*sender, *has_gone) = (None, true);
        }
    }

    /// Returns the received bytes.
    ///
    /// # Errors
    /// The connection fails; a sender that leaves is no error.
    pub fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.accept()?;
        if bytes.is_empty() {
            return Ok(0);
        }
        let count = match self {
            Self::Tcp { sender: Some(sender), .. } => sender.read(bytes),
            Self::Tcp { sender: None, .. } => return Ok(0),
            #[cfg(unix)]
            Self::Pty(pty) => return pty.read(bytes),
        };
        match count {
            Ok(0) => self.lose(),
            Ok(count) => return Ok(count),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
            Err(_) => self.lose(),
        }
        Ok(0)
    }

    /// Writes as many bytes as possible, and keeps the rest. Without a sender all bytes are dropped.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn write(&mut self, out: &mut Vec<u8>) -> io::Result<()> {
        while !out.is_empty() {
            let count = match self {
                Self::Tcp { sender: Some(sender), .. } => sender.write(out),
                Self::Tcp { sender: None, .. } => {
                    out.clear();
                    return Ok(());
                }
                #[cfg(unix)]
                Self::Pty(pty) => pty.write(out),
            };
            match count {
                Ok(0) => break,
                Ok(count) => _ = out.drain(..count),
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => break,
                Err(_) => {
                    self.lose();
                    out.clear();
                }
            }
        }
        Ok(())
    }
}

#[cfg(unix)]
mod pty {
    use rustix::fs::{Mode, OFlags, fcntl_setfl, open};
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
    use std::fs::File;
    use std::io::{self, ErrorKind, Read, Write};
    use std::os::fd::OwnedFd;

    /// Both ends.
    pub struct Pty {
        near: File,
        /// This end is kept open; otherwise reading fails when a sender leaves.
        _far: OwnedFd,
        pub name: String,
    }

    impl Pty {
        pub fn new() -> io::Result<Self> {
            let near = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
            grantpt(&near)?;
            unlockpt(&near)?;
            let name = ptsname(&near, Vec::new())?.to_string_lossy().into_owned();
            let far = open(name.as_str(), OFlags::RDWR | OFlags::NOCTTY, Mode::empty())?;
            let mut modes = tcgetattr(&far)?;
            modes.make_raw();
            tcsetattr(&far, OptionalActions::Now, &modes)?;
            fcntl_setfl(&near, OFlags::RDWR | OFlags::NONBLOCK)?;
            Ok(Self { near: File::from(near), _far: far, name })
        }

        pub fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
            match self.near.read(bytes) {
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => Ok(0),
                other => other,
            }
        }

        pub fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.near.write(bytes)
        }
    }
}
