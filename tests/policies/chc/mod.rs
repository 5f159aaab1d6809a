//! CHC and CHC++ by hand: small trees, scripted answers, and the exact sequence of actions that each
//! rule and each trap of the papers asks for.

mod coherent;
mod floor;
mod multiqueries;
mod nohc;
mod plus_plus;
mod script;
mod terms;
