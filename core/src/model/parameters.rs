//! Parameters that only one control model has, read from `assets/models/parameters/`. They have
//! files of their own because a program that uses none of them is checked without reading them.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use gsk_messages::Language;
use serde::Deserialize;

use super::ModelId;
use super::contacts::ContactAssignment;
use super::record::{ModelRecord, read_ron};

/// A parameter that only one model has.
#[derive(Clone, Debug, Deserialize)]
pub struct ModelParameter {
    /// Name of the parameter in English and Chinese.
    name: BilingualName,
    /// Unit of the value; empty without one.
    pub unit: String,
    /// Least and greatest value of the parameter.
    pub range: (i32, i32),
    /// The value of the parameter as delivered.
    pub delivered: i32,
}

#[derive(Clone, Debug, Deserialize)]
struct BilingualName {
    en: String,
    zh: String,
}

impl ModelParameter {
    /// The name of the parameter in the language `language`.
    pub fn name(&self, language: Language) -> &str {
        match language {
            Language::Zh => &self.name.zh,
            Language::En => &self.name.en,
        }
    }
}

impl ModelRecord {
    /// The parameters that only this model has, by number; read at the first call.
    pub fn parameters(&self) -> &'static BTreeMap<u16, ModelParameter> {
        static PARAMETERS: [LazyLock<BTreeMap<u16, ModelParameter>>; 4] = [
            LazyLock::new(|| {
                read_ron(include_str!(
                    "../../../assets/models/parameters/gsk980td.ron"
                ))
            }),
            LazyLock::new(|| {
                read_ron(include_str!(
                    "../../../assets/models/parameters/gsk980mdi.ron"
                ))
            }),
            LazyLock::new(|| read_ron(include_str!("../../../assets/models/parameters/hx31.ron"))),
            LazyLock::new(|| {
                let text = include_str!("../../../assets/models/parameters/ncb08.ron");
                let mut parameters: BTreeMap<u16, ModelParameter> = read_ron(text);
                parameters.extend(contact_parameters(ModelId::Ncb08));
                parameters
            }),
        ];
        &PARAMETERS[self.id() as usize]
    }
}

/// The parameters that assign the contacts of a model.
fn contact_parameters(id: ModelId) -> impl Iterator<Item = (u16, ModelParameter)> {
    let contacts = id.record().contacts.iter();
    let parameters = contacts.flat_map(ContactAssignment::parameters);
    parameters.map(|it| {
        let name = BilingualName {
            en: it.name_en,
            zh: it.name_zh,
        };
        let parameter = ModelParameter {
            name,
            unit: "-".to_owned(),
            range: (-it.greatest, it.greatest),
            delivered: it.delivered,
        };
        (it.number, parameter)
    })
}
