//! TLS to a broker: trusted authorities, algorithms, and what each refusal means.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::sync::Arc;

use gsk_messages::{Message, say};
use gsk_telemetry::BrokerUrl;
use rustls::crypto::WebPkiSupportedAlgorithms;
use rustls::crypto::ring::{cipher_suite as suite, kx_group};
use rustls::crypto::{CryptoProvider, GetRandomFailed, KeyProvider, SecureRandom};
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer, ServerName};
use rustls::sign::SigningKey;
use rustls::{CertificateError, ClientConfig, ClientConnection, Error as TlsError};
use rustls::{RootCertStore, SignatureScheme};
use webpki::ring as signature;

use crate::platform::{self, BrokerBytes, BrokerFailure};

/// Greatest size of a file with certificates, bytes.
const MAX_CA_BYTES: u64 = 4 * 1024 * 1024;

/// The signatures of certificates and of the handshake: those of a broker on the internet and of
/// an authority made with OpenSSL.
static SIGNATURES: WebPkiSupportedAlgorithms = WebPkiSupportedAlgorithms {
    all: &[
        signature::ECDSA_P256_SHA256,
        signature::ECDSA_P256_SHA384,
        signature::ECDSA_P384_SHA256,
        signature::ECDSA_P384_SHA384,
        signature::ED25519,
        signature::RSA_PSS_2048_8192_SHA256_LEGACY_KEY,
        signature::RSA_PSS_2048_8192_SHA384_LEGACY_KEY,
        signature::RSA_PSS_2048_8192_SHA512_LEGACY_KEY,
        signature::RSA_PKCS1_2048_8192_SHA256,
        signature::RSA_PKCS1_2048_8192_SHA384,
        signature::RSA_PKCS1_2048_8192_SHA512,
    ],
    // TLS 1.2 does not fix the curve of an ECDSA signature.
    mapping: &[
        (
            SignatureScheme::ECDSA_NISTP256_SHA256,
            &[signature::ECDSA_P256_SHA256, signature::ECDSA_P384_SHA256],
        ),
        (
            SignatureScheme::ECDSA_NISTP384_SHA384,
            &[signature::ECDSA_P384_SHA384, signature::ECDSA_P256_SHA384],
        ),
        (SignatureScheme::ED25519, &[signature::ED25519]),
        (
            SignatureScheme::RSA_PSS_SHA256,
            &[signature::RSA_PSS_2048_8192_SHA256_LEGACY_KEY],
        ),
        (
            SignatureScheme::RSA_PSS_SHA384,
            &[signature::RSA_PSS_2048_8192_SHA384_LEGACY_KEY],
        ),
        (
            SignatureScheme::RSA_PSS_SHA512,
            &[signature::RSA_PSS_2048_8192_SHA512_LEGACY_KEY],
        ),
        (
            SignatureScheme::RSA_PKCS1_SHA256,
            &[signature::RSA_PKCS1_2048_8192_SHA256],
        ),
        (
            SignatureScheme::RSA_PKCS1_SHA384,
            &[signature::RSA_PKCS1_2048_8192_SHA384],
        ),
        (
            SignatureScheme::RSA_PKCS1_SHA512,
            &[signature::RSA_PKCS1_2048_8192_SHA512],
        ),
    ],
};

/// Random numbers of the system, and no private keys: a password identifies the program.
#[derive(Debug)]
struct SystemSource;

impl SecureRandom for SystemSource {
    fn fill(&self, buffer: &mut [u8]) -> Result<(), GetRandomFailed> {
        getrandom::fill(buffer).map_err(|_| GetRandomFailed)
    }
}

impl KeyProvider for SystemSource {
    fn load_private_key(
        &self,
        _key: PrivateKeyDer<'static>,
    ) -> Result<Arc<dyn SigningKey>, TlsError> {
        Err(TlsError::General("no private keys".to_owned()))
    }
}

/// TLS 1.3 and 1.2 with AES. The whole provider of the library brings private keys, too.
fn algorithms() -> CryptoProvider {
    CryptoProvider {
        cipher_suites: vec![
            suite::TLS13_AES_256_GCM_SHA384,
            suite::TLS13_AES_128_GCM_SHA256,
            suite::TLS_ECDHE_ECDSA_WITH_AES_256_GCM_SHA384,
            suite::TLS_ECDHE_ECDSA_WITH_AES_128_GCM_SHA256,
            suite::TLS_ECDHE_RSA_WITH_AES_256_GCM_SHA384,
            suite::TLS_ECDHE_RSA_WITH_AES_128_GCM_SHA256,
        ],
        kx_groups: vec![kx_group::X25519, kx_group::SECP256R1, kx_group::SECP384R1],
        signature_verification_algorithms: SIGNATURES,
        secure_random: &SystemSource,
        key_provider: &SystemSource,
    }
}

/// The certificates of the trusted authorities: those of a file, or of the system.
fn trusted_authorities(file: Option<&Path>) -> Result<RootCertStore, Message> {
    let mut authorities = RootCertStore::empty();
    let Some(path) = file else {
        let found = rustls_native_certs::load_native_certs();
        authorities.add_parsable_certificates(found.certs);
        return match authorities.is_empty() {
            true => Err(say::tls_no_system_authorities()),
            false => Ok(authorities),
        };
    };
    let bytes = platform::read(path, MAX_CA_BYTES)
        .map_err(|error| say::tls_ca_unreadable(path.display(), say::as_written(error)))?;
    let certificates = CertificateDer::pem_slice_iter(&bytes).filter_map(Result::ok);
    authorities.add_parsable_certificates(certificates);
    match authorities.is_empty() {
        true => Err(say::tls_ca_empty(path.display())),
        false => Ok(authorities),
    }
}

/// The client side of a TLS connection.
#[derive(Debug)]
pub(super) struct TlsSession {
    connection: ClientConnection,
    host: String,
}

impl TlsSession {
    /// Prepares a connection to a broker, whose certificate must name its host.
    ///
    /// # Errors
    /// No authorities are found, or the host can have no certificate.
    pub(super) fn new(url: &BrokerUrl) -> Result<Self, BrokerFailure> {
        let authorities = trusted_authorities(url.ca_file.as_deref())?;
        let failed = |error: TlsError| say::tls_failed(error);
        let config = ClientConfig::builder_with_provider(Arc::new(algorithms()))
            .with_safe_default_protocol_versions()
            .map_err(failed)?
            .with_root_certificates(authorities)
            .with_no_client_auth();
        let name = ServerName::try_from(url.host.clone());
        let name = name.map_err(|_| say::tls_wrong_name(&url.host))?;
        let connection = ClientConnection::new(Arc::new(config), name).map_err(failed)?;
        Ok(Self {
            connection,
            host: url.host.clone(),
        })
    }

    /// Whether the handshake is complete.
    pub(super) fn is_established(&self) -> bool {
        !self.connection.is_handshaking()
    }

    pub(super) fn read(
        &mut self,
        stream: &mut TcpStream,
        buffer: &mut [u8],
    ) -> Result<BrokerBytes, BrokerFailure> {
        self.flush(stream)?;
        // The library takes no further bytes before these are read.
        match self.connection.reader().read(buffer) {
            Ok(count) if count > 0 => return Ok(BrokerBytes::Received(count)),
            _ => {}
        }
        match self.connection.read_tls(stream) {
            Ok(0) if !self.is_established() => return Err(say::tls_missing().into()),
            Ok(_) => {}
            Err(error) if is_timeout(&error) => return Ok(BrokerBytes::Received(0)),
            // A server that understands no TLS closes the connection in its own way.
            Err(_) if !self.is_established() => return Err(say::tls_missing().into()),
            Err(error) => return Err(error.into()),
        }
        if let Err(error) = self.connection.process_new_packets() {
            // The broker learns why; it may be gone.
            let _ = self.flush(stream);
            return Err(self.describe(&error).into());
        }
        match self.connection.reader().read(buffer) {
            Ok(0) => Ok(BrokerBytes::Closed),
            Ok(count) => Ok(BrokerBytes::Received(count)),
            Err(error) if is_timeout(&error) => Ok(BrokerBytes::Received(0)),
            // Closed without a last word.
            Err(_) => Ok(BrokerBytes::Closed),
        }
    }

    pub(super) fn write(
        &mut self,
        stream: &mut TcpStream,
        mut bytes: &[u8],
    ) -> Result<(), BrokerFailure> {
        while !bytes.is_empty() {
            let count = self.connection.writer().write(bytes)?;
            if count == 0 && !self.connection.wants_write() {
                return Err(say::mqtt_silent().into());
            }
            bytes = &bytes[count..];
            self.flush(stream)?;
        }
        Ok(())
    }

    /// Sends the encrypted bytes that are ready.
    fn flush(&mut self, stream: &mut TcpStream) -> Result<(), BrokerFailure> {
        while self.connection.wants_write() {
            match self.connection.write_tls(stream) {
                Ok(_) => {}
                Err(_) if !self.is_established() => return Err(say::tls_missing().into()),
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }

    pub(super) fn close(&mut self, stream: &mut TcpStream) {
        self.connection.send_close_notify();
        // The broker may be gone.
        let _ = self.flush(stream);
    }

    /// Why TLS has ended, as a sentence with its remedy.
    fn describe(&self, error: &TlsError) -> Message {
        match error {
            TlsError::InvalidCertificate(reason) => self.describe_certificate(reason),
            TlsError::InvalidMessage(_) => say::tls_missing(),
            _ => say::tls_failed(error),
        }
    }

    fn describe_certificate(&self, reason: &CertificateError) -> Message {
        use CertificateError as Reason;
        match reason {
            Reason::UnknownIssuer => say::tls_unknown_authority(),
            Reason::NotValidForName | Reason::NotValidForNameContext { .. } => {
                say::tls_wrong_name(&self.host)
            }
            Reason::Expired | Reason::ExpiredContext { .. } => say::tls_expired(),
            Reason::NotValidYet | Reason::NotValidYetContext { .. } => say::tls_not_valid_yet(),
            _ => say::tls_failed(TlsError::InvalidCertificate(reason.clone())),
        }
    }
}

/// Whether nothing has arrived in time.
pub(super) fn is_timeout(error: &io::Error) -> bool {
    use io::ErrorKind::{Interrupted, TimedOut, WouldBlock};
    matches!(error.kind(), WouldBlock | TimedOut | Interrupted)
}
