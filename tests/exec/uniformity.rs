//! Whether barriers stand in control flow that is uniform by the rules of WGSL. naga itself does
//! not look.
//!
//! This is stricter than the standard: a variable is uniform only if whatever is ever stored to it
//! is, and what functions return never is.

use naga::{
    AddressSpace, Binding, Block, BuiltIn, Expression, Function, Handle, LocalVariable, Module,
    Statement, StorageAccess,
};
use std::collections::HashSet;

/// How many barriers of the module's entry points a browser refuses.
pub fn divergent_barriers(module: &Module) -> usize {
    let entries = module.entry_points.iter();
    entries.map(|entry| divergent_in(module, &entry.function, true)).sum()
}

/// The barriers of a function that is called from control flow of which `uniform` is told.
fn divergent_in(module: &Module, function: &Function, uniform: bool) -> usize {
    let mut analysis = Analysis { module, function, varying: HashSet::new(), divergent: 0 };
    // What is found to vary makes more vary.
    loop {
        let before = analysis.varying.len();
        analysis.divergent = 0;
        analysis.block(&function.body, uniform);
        if analysis.varying.len() == before {
            return analysis.divergent;
        }
    }
}

/// Ways in which some threads of a workgroup may have left a block where others have not.
#[derive(Clone, Copy, Default)]
struct Left {
    /// The loop or `switch` around it.
    inner: bool,
    /// The iteration of the loop around it.
    iteration: bool,
    function: bool,
}

impl Left {
    fn any(self) -> bool {
        self.inner || self.iteration || self.function
    }

    fn or(self, other: Self) -> Self {
        Self {
            inner: self.inner || other.inner,
            iteration: self.iteration || other.iteration,
            function: self.function || other.function,
        }
    }
}

struct Analysis<'a> {
    module: &'a Module,
    function: &'a Function,
    /// Variables that may differ from thread to thread.
    varying: HashSet<Handle<LocalVariable>>,
    divergent: usize,
}

impl Analysis<'_> {
    fn block(&mut self, block: &Block, uniform: bool) -> Left {
        let mut left = Left::default();
        for statement in block {
            let uniform = uniform && !left.any();
            left = left.or(self.statement(statement, uniform));
        }
        left
    }

    fn statement(&mut self, statement: &Statement, uniform: bool) -> Left {
        match statement {
            Statement::ControlBarrier(_) | Statement::WorkGroupUniformLoad { .. } => {
                self.divergent += usize::from(!uniform);
            }
            Statement::Break => return Left { inner: !uniform, ..Left::default() },
            Statement::Continue => return Left { iteration: !uniform, ..Left::default() },
            Statement::Return { .. } | Statement::Kill => {
                return Left { function: !uniform, ..Left::default() };
            }
            Statement::Store { pointer, value }
                if !(uniform && self.is_uniform(*value) && self.has_uniform_place(*pointer)) =>
            {
                self.vary(*pointer);
            }
            Statement::Call { function, arguments, .. } => {
                arguments.iter().for_each(|&argument| self.vary(argument));
                let callee = &self.module.functions[*function];
                self.divergent += divergent_in(self.module, callee, uniform);
            }
            Statement::Block(block) => return self.block(block, uniform),
            Statement::If { condition, accept, reject } => {
                let uniform = uniform && self.is_uniform(*condition);
                return self.block(accept, uniform).or(self.block(reject, uniform));
            }
            Statement::Switch { selector, cases } => {
                let uniform = uniform && self.is_uniform(*selector);
                let left = cases.iter().fold(Left::default(), |left, case| {
                    left.or(self.block(&case.body, uniform && !left.any()))
                });
                return Left { inner: false, ..left };
            }
            Statement::Loop { body, continuing, break_if } => {
                let before = self.divergent;
                let mut left = self.iteration(body, continuing, *break_if, uniform);
                // Whoever left is missing in the next iteration.
                if left.any() {
                    self.divergent = before;
                    left = self.iteration(body, continuing, *break_if, false);
                }
                return Left { function: left.function, ..Left::default() };
            }
            _ => {}
        }
        Left::default()
    }

    fn iteration(
        &mut self,
        body: &Block,
        continuing: &Block,
        break_if: Option<Handle<Expression>>,
        uniform: bool,
    ) -> Left {
        let left = self.block(body, uniform);
        let left = left.or(self.block(continuing, uniform && !left.any()));
        let ends_together = break_if.is_none_or(|condition| self.is_uniform(condition));
        left.or(Left { inner: !ends_together, ..Left::default() })
    }

    /// Remembers that the variable that an expression points into, if it does, varies.
    fn vary(&mut self, pointer: Handle<Expression>) {
        match self.function.expressions[pointer] {
            Expression::LocalVariable(variable) => {
                self.varying.insert(variable);
            }
            Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => {
                self.vary(base);
            }
            _ => {}
        }
    }

    /// Whether all threads mean the same place by a pointer.
    fn has_uniform_place(&self, pointer: Handle<Expression>) -> bool {
        match self.function.expressions[pointer] {
            Expression::Access { base, index } => {
                self.has_uniform_place(base) && self.is_uniform(index)
            }
            Expression::AccessIndex { base, .. } => self.has_uniform_place(base),
            Expression::LocalVariable(_) | Expression::GlobalVariable(_) => true,
            _ => false,
        }
    }

    fn is_uniform(&self, expression: Handle<Expression>) -> bool {
        let all = |parts: &[Handle<Expression>]| parts.iter().all(|&part| self.is_uniform(part));
        match &self.function.expressions[expression] {
            Expression::Literal(_)
            | Expression::Constant(_)
            | Expression::Override(_)
            | Expression::ZeroValue(_)
            | Expression::ArrayLength(_) => true,
            Expression::LocalVariable(variable) => !self.varying.contains(variable),
            // What all threads share and none writes. Private variables vary, says WGSL.
            Expression::GlobalVariable(variable) => matches!(
                self.module.global_variables[*variable].space,
                AddressSpace::Uniform | AddressSpace::Storage { access: StorageAccess::LOAD }
            ),
            Expression::FunctionArgument(number) => self.is_uniform_argument(*number),
            Expression::Compose { components, .. } => all(components),
            Expression::Access { base, index } => all(&[*base, *index]),
            Expression::AccessIndex { base, .. } => all(&[*base]),
            Expression::Splat { value, .. } => all(&[*value]),
            Expression::Swizzle { vector, .. } => all(&[*vector]),
            Expression::Load { pointer } => all(&[*pointer]),
            Expression::Unary { expr, .. } | Expression::As { expr, .. } => all(&[*expr]),
            Expression::Binary { left, right, .. } => all(&[*left, *right]),
            Expression::Select { condition, accept, reject } => {
                all(&[*condition, *accept, *reject])
            }
            Expression::Relational { argument, .. } => all(&[*argument]),
            Expression::Math { arg, arg1, arg2, arg3, .. } => {
                all(&[*arg]) && [arg1, arg2, arg3].into_iter().flatten().all(|&a| all(&[a]))
            }
            _ => false,
        }
    }

    /// Whether an argument is one that the whole workgroup is given.
    fn is_uniform_argument(&self, number: u32) -> bool {
        let binding = self.function.arguments[number as usize].binding.as_ref();
        matches!(binding, Some(Binding::BuiltIn(BuiltIn::WorkGroupId | BuiltIn::NumWorkGroups)))
    }
}
