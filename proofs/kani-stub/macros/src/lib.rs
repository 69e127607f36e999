//! The attributes of a Kani harness, which say nothing here but must be well-formed.

use proc_macro::{TokenStream, TokenTree};

/// `#[kani::proof]`
#[proc_macro_attribute]
pub fn proof(arguments: TokenStream, item: TokenStream) -> TokenStream {
    assert!(arguments.is_empty(), "proof takes no argument");
    // As Kani's own does: nothing calls a harness.
    "#[allow(dead_code)]".parse::<TokenStream>().expect("an attribute").into_iter().chain(item).collect()
}

/// `#[kani::unwind(N)]`
#[proc_macro_attribute]
pub fn unwind(arguments: TokenStream, item: TokenStream) -> TokenStream {
    let tokens: Vec<TokenTree> = arguments.into_iter().collect();
    assert!(matches!(tokens.as_slice(), [TokenTree::Literal(n)] if n.to_string().parse::<u32>().is_ok()), "unwind takes a number");
    item
}

/// `#[kani::solver(NAME)]`
#[proc_macro_attribute]
pub fn solver(arguments: TokenStream, item: TokenStream) -> TokenStream {
    let tokens: Vec<TokenTree> = arguments.into_iter().collect();
    let known = |name: &str| ["cadical", "minisat", "kissat"].contains(&name);
    assert!(matches!(tokens.as_slice(), [TokenTree::Ident(name)] if known(&name.to_string())), "solver takes a name");
    item
}
