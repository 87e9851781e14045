(* SPDX-License-Identifier: BSD-3-Clause *)
(** * Affine functions of points, carried from frame to frame

    As verify/motion.h: f(x) = v.x + d is known in the coordinates of one frame, and asked for in others. A frame stands
    in its parent by a list of steps (its origin, turns, slides); each step is passed in either direction. *)
From Coq Require Import Reals ZArith Lia Lra Bool List.
From FclArtic Require Import Statement Numbers Trig.
Import ListNotations.
Open Scope R_scope.

(** ** Vectors of models *)

Record tvec := Tvec { tx : tm; ty : tm; tz : tm }.

Definition holdsv (v : tvec) (s : R) (x : vec) : Prop :=
  holds (tx v) s (vx x) /\ holds (ty v) s (vy x) /\ holds (tz v) s (vz x).

Definition tadd (a b : tvec) := Tvec (tm_add (tx a) (tx b)) (tm_add (ty a) (ty b)) (tm_add (tz a) (tz b)).
Definition tscale (l : tm) (a : tvec) := Tvec (tm_mul l (tx a)) (tm_mul l (ty a)) (tm_mul l (tz a)).
Definition tdot (a b : tvec) : tm :=
  tm_add (tm_add (tm_mul (tx a) (tx b)) (tm_mul (ty a) (ty b))) (tm_mul (tz a) (tz b)).
Definition tcross (a b : tvec) : tvec :=
  Tvec (tm_sub (tm_mul (ty a) (tz b)) (tm_mul (tz a) (ty b)))
       (tm_sub (tm_mul (tz a) (tx b)) (tm_mul (tx a) (tz b)))
       (tm_sub (tm_mul (tx a) (ty b)) (tm_mul (ty a) (tx b))).

Section AtOneTime.
Variable s : R.
Hypothesis Hs : Rabs s <= 1.

Lemma holdsv_add a b x y : holdsv a s x -> holdsv b s y -> holdsv (tadd a b) s (add x y).
Proof. intros (A & B & C) (D & E & F). repeat split; apply holds_add; assumption. Qed.
Lemma holdsv_scale l a k x : holds l s k -> holdsv a s x -> holdsv (tscale l a) s (scale k x).
Proof. intros L (A & B & C). repeat split; apply holds_mul; assumption. Qed.
Lemma holds_dot a b x y : holdsv a s x -> holdsv b s y -> holds (tdot a b) s (dot x y).
Proof. intros (A & B & C) (D & E & F). repeat apply holds_add; apply holds_mul; assumption. Qed.
Lemma holdsv_cross a b x y : holdsv a s x -> holdsv b s y -> holdsv (tcross a b) s (cross x y).
Proof. intros (A & B & C) (D & E & F). repeat split; apply holds_sub; apply holds_mul; assumption. Qed.

(** ** Rotations *)

Definition transpose (m : mat) := Mat (column1 m) (column2 m) (column3 m).

Ltac coordinates :=
  unfold apply, transpose, column1, column2, column3, cross, sub, add, scale, dot in *; cbn [vx vy vz row1 row2 row3] in *.

Lemma dot_apply m v x : dot v (apply m x) = dot (apply (transpose m) v) x.
Proof. destruct m, v, x. coordinates. ring. Qed.

Lemma rotation_keeps_dot m v x : rotation m -> dot (apply m v) (apply m x) = dot v x.
Proof.
  intros (H1 & H2 & H3 & H4 & H5 & H6 & _).
  transitivity (vx v * vx x * dot (column1 m) (column1 m) + vy v * vy x * dot (column2 m) (column2 m) +
    vz v * vz x * dot (column3 m) (column3 m) + (vx v * vy x + vy v * vx x) * dot (column1 m) (column2 m) +
    (vx v * vz x + vz v * vx x) * dot (column1 m) (column3 m) + (vy v * vz x + vz v * vy x) * dot (column2 m) (column3 m)).
  - destruct m as [[] [] []], v, x. coordinates. ring.
  - rewrite H1, H2, H3, H4, H5, H6. unfold dot. ring.
Qed.

(** The transpose of a rotation is its adjugate: m^T = m^T (m adj m) = (m^T m) adj m = adj m. *)
Lemma transpose_is_rotation m : rotation m -> rotation (transpose m).
Proof.
  intros (H1 & H2 & H3 & H4 & H5 & H6 & HD). destruct m as [[a b c] [d e f] [g h i]]. coordinates.
  assert (A : a = e * i - f * h).
  { transitivity (a * 1); [ring|]. rewrite <- HD.
    transitivity ((a * a + d * d + g * g) * (e * i - f * h) + (a * b + d * e + g * h) * (f * g - d * i) +
                  (a * c + d * f + g * i) * (d * h - e * g)); [ring|]. rewrite H1, H4, H5. ring. }
  assert (B : b = f * g - d * i).
  { transitivity (b * 1); [ring|]. rewrite <- HD.
    transitivity ((a * b + d * e + g * h) * (e * i - f * h) + (b * b + e * e + h * h) * (f * g - d * i) +
                  (b * c + e * f + h * i) * (d * h - e * g)); [ring|]. rewrite H4, H2, H6. ring. }
  assert (C : c = d * h - e * g).
  { transitivity (c * 1); [ring|]. rewrite <- HD.
    transitivity ((a * c + d * f + g * i) * (e * i - f * h) + (b * c + e * f + h * i) * (f * g - d * i) +
                  (c * c + f * f + i * i) * (d * h - e * g)); [ring|]. rewrite H5, H6, H3. ring. }
  assert (D : d = c * h - b * i).
  { transitivity (d * 1); [ring|]. rewrite <- HD.
    transitivity ((a * a + d * d + g * g) * (c * h - b * i) + (a * b + d * e + g * h) * (a * i - c * g) +
                  (a * c + d * f + g * i) * (b * g - a * h)); [ring|]. rewrite H1, H4, H5. ring. }
  assert (E : e = a * i - c * g).
  { transitivity (e * 1); [ring|]. rewrite <- HD.
    transitivity ((a * b + d * e + g * h) * (c * h - b * i) + (b * b + e * e + h * h) * (a * i - c * g) +
                  (b * c + e * f + h * i) * (b * g - a * h)); [ring|]. rewrite H4, H2, H6. ring. }
  assert (F : f = b * g - a * h).
  { transitivity (f * 1); [ring|]. rewrite <- HD.
    transitivity ((a * c + d * f + g * i) * (c * h - b * i) + (b * c + e * f + h * i) * (a * i - c * g) +
                  (c * c + f * f + i * i) * (b * g - a * h)); [ring|]. rewrite H5, H6, H3. ring. }
  assert (G : g = b * f - c * e).
  { transitivity (g * 1); [ring|]. rewrite <- HD.
    transitivity ((a * a + d * d + g * g) * (b * f - c * e) + (a * b + d * e + g * h) * (c * d - a * f) +
                  (a * c + d * f + g * i) * (a * e - b * d)); [ring|]. rewrite H1, H4, H5. ring. }
  assert (H : h = c * d - a * f).
  { transitivity (h * 1); [ring|]. rewrite <- HD.
    transitivity ((a * b + d * e + g * h) * (b * f - c * e) + (b * b + e * e + h * h) * (c * d - a * f) +
                  (b * c + e * f + h * i) * (a * e - b * d)); [ring|]. rewrite H4, H2, H6. ring. }
  assert (I : i = a * e - b * d).
  { transitivity (i * 1); [ring|]. rewrite <- HD.
    transitivity ((a * c + d * f + g * i) * (b * f - c * e) + (b * c + e * f + h * i) * (c * d - a * f) +
                  (c * c + f * f + i * i) * (a * e - b * d)); [ring|]. rewrite H5, H6, H3. ring. }
  unfold rotation. coordinates. repeat split.
  - transitivity (a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g)); [congruence | lra].
  - transitivity (d * (c * h - b * i) + e * (a * i - c * g) + f * (b * g - a * h)); [congruence | lra].
  - transitivity (g * (b * f - c * e) + h * (c * d - a * f) + i * (a * e - b * d)); [congruence | lra].
  - transitivity (d * (e * i - f * h) + e * (f * g - d * i) + f * (d * h - e * g)); [|ring].
    rewrite <- A, <- B, <- C. ring.
  - transitivity (g * (e * i - f * h) + h * (f * g - d * i) + i * (d * h - e * g)); [|ring].
    rewrite <- A, <- B, <- C. ring.
  - transitivity (g * (c * h - b * i) + h * (a * i - c * g) + i * (b * g - a * h)); [|ring].
    rewrite <- D, <- E, <- F. ring.
  - lra.
Qed.

Definition turned (k : vec) (sn cs : R) (x : vec) : vec :=
  add (add (scale cs x) (scale sn (cross k x))) (scale ((1 - cs) * dot k x) k).

Lemma dot_turned k sn cs v x : dot v (turned k sn cs x) = dot (turned k (- sn) cs v) x.
Proof. destruct k, v, x. unfold turned. coordinates. ring. Qed.

Lemma turned_keeps_dot k sn cs v x : dot k k = 1 -> sn * sn + cs * cs = 1 ->
  dot (turned k sn cs v) (turned k sn cs x) = dot v x.
Proof.
  intros K S.
  transitivity (cs * cs * dot v x + sn * sn * (dot k k * dot v x - dot k v * dot k x) +
                (2 * cs * (1 - cs) + (1 - cs) * (1 - cs) * dot k k) * (dot k v * dot k x)).
  - destruct k, v, x. unfold turned. coordinates. ring.
  - rewrite K.
    transitivity ((sn * sn + cs * cs) * dot v x + (1 - (sn * sn + cs * cs)) * (dot k v * dot k x)); [ring|].
    rewrite S. ring.
Qed.

(** The turn about u by an angle of which |u| is the sine and c the cosine of the half. *)
Definition spun (u : vec) (c : R) (x : vec) : vec :=
  add (add (scale (2 * (c * c) - 1) x) (scale (2 * c) (cross u x))) (scale (2 * dot u x) u).

Lemma dot_spun u c v x : dot v (spun u c x) = dot (spun (scale (-1) u) c v) x.
Proof. destruct u, v, x. unfold spun. coordinates. ring. Qed.

Lemma spun_keeps_dot u c v x : c * c + dot u u = 1 -> dot (spun u c v) (spun u c x) = dot v x.
Proof.
  intros S.
  transitivity (((2 * (c * c) - 1) * (2 * (c * c) - 1) + 4 * (c * c) * dot u u) * dot v x +
                (4 * dot u u - 4 * (c * c) + 4 * (2 * (c * c) - 1)) * (dot u v * dot u x)).
  - destruct u, v, x. unfold spun. coordinates. ring.
  - replace (dot u u) with (1 - c * c) by lra. ring.
Qed.

(** ** Steps *)

Inductive step :=
  | Turned (k : tvec) (sn cs : tm)
  | Slid (k : tvec) (way : tm)
  | Spun (u : tvec) (c : tm)
  | Placed (m1 m2 m3 : tvec) (p : tvec).      (* a matrix by rows, and a translation *)

Inductive holds_step : step -> (vec -> vec) -> Prop :=
  | holds_turned km snm csm k sn cs E : holdsv km s k -> holds snm s sn -> holds csm s cs ->
      dot k k = 1 -> sn * sn + cs * cs = 1 -> (forall x, E x = turned k sn cs x) -> holds_step (Turned km snm csm) E
  | holds_slid km wm k way E : holdsv km s k -> holds wm s way -> (forall x, E x = add x (scale way k)) ->
      holds_step (Slid km wm) E
  | holds_spun um cm u c E : holdsv um s u -> holds cm s c -> c * c + dot u u = 1 -> (forall x, E x = spun u c x) ->
      holds_step (Spun um cm) E
  | holds_placed a b c pm m p E : holdsv a s (row1 m) -> holdsv b s (row2 m) -> holdsv c s (row3 m) ->
      holdsv pm s p -> rotation m -> (forall x, E x = add (apply m x) p) -> holds_step (Placed a b c pm) E.

Record func := Func { fv : tvec; fd : tm }.
Definition holdsf (f : func) (v : vec) (d : R) : Prop := holdsv (fv f) s v /\ holds (fd f) s d.

Definition tturned (k : tvec) (sn cs : tm) (v : tvec) : tvec :=
  tadd (tadd (tscale cs v) (tscale sn (tcross k v))) (tscale (tm_mul (tm_sub tm_one cs) (tdot k v)) k).

Lemma holdsv_turned km snm csm k sn cs vm v : holdsv km s k -> holds snm s sn -> holds csm s cs -> holdsv vm s v ->
  holdsv (tturned km snm csm vm) s (turned k sn cs v).
Proof.
  intros. repeat apply holdsv_add; apply holdsv_scale; try assumption.
  - apply holdsv_cross; assumption.
  - apply holds_mul; [assumption | apply holds_sub; [apply holds_one | assumption] | apply holds_dot; assumption].
Qed.

Definition topp (v : tvec) : tvec := Tvec (tm_opp (tx v)) (tm_opp (ty v)) (tm_opp (tz v)).
Lemma holdsv_opp vm v : holdsv vm s v -> holdsv (topp vm) s (scale (-1) v).
Proof.
  intros (A & B & C). unfold scale.
  repeat split; cbn [topp tx ty tz vx vy vz]; (eapply holds_eq; [|apply holds_opp; eassumption]; ring).
Qed.

Definition tspun (u : tvec) (c : tm) (v : tvec) : tvec :=
  let c2 := tm_mul c c in let d := tdot u v in
  tadd (tadd (tscale (tm_sub (tm_add c2 c2) tm_one) v) (tscale (tm_add c c) (tcross u v))) (tscale (tm_add d d) u).

Lemma holdsv_spun um cm u c vm v : holdsv um s u -> holds cm s c -> holdsv vm s v ->
  holdsv (tspun um cm vm) s (spun u c v).
Proof.
  intros Hu Hc Hv. unfold tspun, spun.
  replace (2 * (c * c) - 1) with (c * c + c * c - 1) by ring. replace (2 * c) with (c + c) by ring.
  replace (2 * dot u v) with (dot u v + dot u v) by ring.
  repeat apply holdsv_add; apply holdsv_scale; try assumption.
  - apply holds_sub; [apply holds_add; apply holds_mul; assumption | apply holds_one].
  - apply holds_add; assumption.
  - apply holdsv_cross; assumption.
  - apply holds_add; apply holds_dot; assumption.
Qed.

(** From the parent's coordinates to the child's, x = E y. *)
Definition down (st : step) (f : func) : func :=
  match st with
  | Turned k sn cs => Func (tturned k (tm_opp sn) cs (fv f)) (fd f)
  | Slid k way => Func (fv f) (tm_add (fd f) (tm_mul way (tdot (fv f) k)))
  | Spun u c => Func (tspun (topp u) c (fv f)) (fd f)
  | Placed a b c p =>
      let v := fv f in
      Func (tadd (tadd (tscale (tx v) a) (tscale (ty v) b)) (tscale (tz v) c)) (tm_add (fd f) (tdot v p))
  end.

(** From the child's coordinates to the parent's. *)
Definition up (st : step) (f : func) : func :=
  match st with
  | Turned k sn cs => Func (tturned k sn cs (fv f)) (fd f)
  | Slid k way => Func (fv f) (tm_sub (fd f) (tm_mul way (tdot (fv f) k)))
  | Spun u c => Func (tspun u c (fv f)) (fd f)
  | Placed a b c p =>
      let v := Tvec (tdot a (fv f)) (tdot b (fv f)) (tdot c (fv f)) in Func v (tm_sub (fd f) (tdot v p))
  end.

Lemma down_ok st E f v d : holds_step st E -> holdsf f v d ->
  exists v' d', holdsf (down st f) v' d' /\ dot v' v' = dot v v /\ forall x, dot v (E x) + d = dot v' x + d'.
Proof.
  intros HE [Hv Hd]. destruct HE as [km snm csm k sn cs E Hk Hsn Hcs K S HE | km wm k way E Hk Hw HE
                                    | um cm u c E Hu Hc K HE | a b c pm m p E Ha Hb Hc Hp R HE].
  - exists (turned k (- sn) cs v), d. split; [|split].
    + split; [|exact Hd]. apply holdsv_turned; try assumption. apply holds_opp. assumption.
    + apply turned_keeps_dot; [exact K|]. rewrite <- S. ring.
    + intros x. rewrite HE, dot_turned. reflexivity.
  - exists v, (d + way * dot v k). split; [|split; [reflexivity|]].
    + split; [exact Hv|]. apply holds_add; [exact Hd|]. apply holds_mul; [exact Hs | exact Hw|].
      apply holds_dot; assumption.
    + intros x. rewrite HE. coordinates. ring.
  - exists (spun (scale (-1) u) c v), d. split; [|split].
    + split; [|exact Hd]. apply holdsv_spun; [apply holdsv_opp | |]; assumption.
    + apply spun_keeps_dot. rewrite <- K. unfold dot, scale; cbn [vx vy vz]. ring.
    + intros x. rewrite HE, dot_spun. reflexivity.
  - exists (apply (transpose m) v), (d + dot v p). split; [|split].
    + destruct Hv as (V1 & V2 & V3). split.
      * replace (apply (transpose m) v) with
          (add (add (scale (vx v) (row1 m)) (scale (vy v) (row2 m))) (scale (vz v) (row3 m))).
        -- cbn [down fv]. repeat apply holdsv_add; apply holdsv_scale; assumption.
        -- destruct m as [[] [] []], v. coordinates. f_equal; ring.
      * cbn [down fd]. apply holds_add; [exact Hd|]. apply holds_dot; [repeat split|]; assumption.
    + apply rotation_keeps_dot. apply transpose_is_rotation. exact R.
    + intros x. rewrite HE. rewrite <- dot_apply. coordinates. ring.
Qed.

Lemma up_ok st E f v d : holds_step st E -> holdsf f v d ->
  exists v' d', holdsf (up st f) v' d' /\ dot v' v' = dot v v /\ forall x, dot v' (E x) + d' = dot v x + d.
Proof.
  intros HE [Hv Hd]. destruct HE as [km snm csm k sn cs E Hk Hsn Hcs K S HE | km wm k way E Hk Hw HE
                                    | um cm u c E Hu Hc K HE | a b c pm m p E Ha Hb Hc Hp R HE].
  - exists (turned k sn cs v), d. split; [|split].
    + split; [|exact Hd]. apply holdsv_turned; assumption.
    + apply turned_keeps_dot; assumption.
    + intros x. rewrite HE, turned_keeps_dot; [reflexivity | assumption | assumption].
  - exists v, (d - way * dot v k). split; [|split; [reflexivity|]].
    + split; [exact Hv|]. apply holds_sub; [exact Hd|]. apply holds_mul; [exact Hs | exact Hw|].
      apply holds_dot; assumption.
    + intros x. rewrite HE. coordinates. ring.
  - exists (spun u c v), d. split; [|split].
    + split; [|exact Hd]. apply holdsv_spun; assumption.
    + apply spun_keeps_dot; assumption.
    + intros x. rewrite HE, spun_keeps_dot by assumption. reflexivity.
  - assert (HV : holdsv (Tvec (tdot a (fv f)) (tdot b (fv f)) (tdot c (fv f))) s (apply m v)).
    { repeat split; apply holds_dot; assumption. }
    exists (apply m v), (d - dot (apply m v) p). split; [|split].
    + split; [exact HV|]. cbn [up fd]. apply holds_sub; [exact Hd|]. apply holds_dot; assumption.
    + apply rotation_keeps_dot. exact R.
    + intros x. rewrite HE. transitivity (dot (apply m v) (apply m x) + d).
      * generalize (apply m v). intros u. coordinates. ring.
      * rewrite rotation_keeps_dot by exact R. reflexivity.
Qed.

(** Lists of steps, the parent's side first. *)
Inductive holds_steps : list step -> (vec -> vec) -> Prop :=
  | no_step E : (forall x, E x = x) -> holds_steps [] E
  | first_step st sts E M N : holds_step st E -> holds_steps sts M -> (forall x, N x = E (M x)) ->
      holds_steps (st :: sts) N.

Lemma steps_app sts E : holds_steps sts E -> forall rest M, holds_steps rest M ->
  holds_steps (sts ++ rest) (fun x => E (M x)).
Proof.
  induction 1 as [E HE | st sts E M N HS HM IH HN]; intros rest L HL; cbn [app].
  - assert (K : forall sts' A, holds_steps sts' A -> forall B, (forall x, B x = A x) -> holds_steps sts' B).
    { intros sts' A [C HC | st sts'' C D F HC HD HF] B HB; [apply no_step | eapply first_step; [exact HC | exact HD|]];
        intros; rewrite HB; auto. }
    eapply K; [exact HL|]. intros. apply HE.
  - eapply first_step; [exact HS | exact (IH _ _ HL)|]. intros x. apply HN.
Qed.

Definition down_all (sts : list step) (f : func) : func := fold_left (fun f st => down st f) sts f.
Definition up_all (sts : list step) (f : func) : func := fold_right up f sts.

Lemma down_all_ok sts E f v d : holds_steps sts E -> holdsf f v d ->
  exists v' d', holdsf (down_all sts f) v' d' /\ dot v' v' = dot v v /\ forall x, dot v (E x) + d = dot v' x + d'.
Proof.
  intros HE. revert f v d. induction HE as [E HE | st sts E M N HS HM IH HN]; intros f v d Hf.
  - exists v, d. split; [exact Hf|]. split; [reflexivity|]. intros x. rewrite HE. reflexivity.
  - destruct (down_ok st E f v d HS Hf) as (v1 & d1 & H1 & N1 & X1).
    destruct (IH _ _ _ H1) as (v2 & d2 & H2 & N2 & X2). exists v2, d2.
    split; [exact H2|]. split; [congruence|]. intros x. rewrite HN, X1, X2. reflexivity.
Qed.

Lemma up_all_ok sts E f v d : holds_steps sts E -> holdsf f v d ->
  exists v' d', holdsf (up_all sts f) v' d' /\ dot v' v' = dot v v /\ forall x, dot v' (E x) + d' = dot v x + d.
Proof.
  intros HE. induction HE as [E HE | st sts E M N HS HM IH HN]; intros Hf.
  - exists v, d. split; [exact Hf|]. split; [reflexivity|]. intros x. rewrite HE. reflexivity.
  - destruct (IH Hf) as (v1 & d1 & H1 & N1 & X1).
    destruct (up_ok st E _ _ _ HS H1) as (v2 & d2 & H2 & N2 & X2). exists v2, d2.
    split; [exact H2|]. split; [congruence|]. intros x. rewrite HN, X2, X1. reflexivity.
Qed.

(** ** Chains of frames *)

(** Frame i + 1 by its parent and its steps, over an interval of time. *)
Definition tree := list (nat * list step).

(** The function in frame i and in all above it. *)
Fixpoint chain (fuel : nat) (fs : tree) (i : nat) (f : func) : list (nat * func) :=
  (i, f) ::
  match fuel, i with
  | S n, S j => match nth_error fs j with Some (p, sts) => chain n fs p (up_all sts f) | None => [] end
  | _, _ => []
  end.

Fixpoint lookup (i : nat) (known : list (nat * func)) : option func :=
  match known with [] => None | (k, f) :: rest => if Nat.eqb k i then Some f else lookup i rest end.

(** The function in any frame: down from the nearest one in which it is known. *)
Fixpoint at_frame (fuel : nat) (fs : tree) (known : list (nat * func)) (i : nat) : option func :=
  match lookup i known with
  | Some f => Some f
  | None =>
      match fuel, i with
      | S n, S j =>
          match nth_error fs j with
          | Some (p, sts) => option_map (down_all sts) (at_frame n fs known p)
          | None => None
          end
      | _, _ => None
      end
  end.

Variable fs : tree.
Variable P : nat -> vec -> vec.
Hypothesis root : forall x, P O x = x.
Hypothesis child : forall i p sts, nth_error fs i = Some (p, sts) ->
  exists E, holds_steps sts E /\ forall x, P (S i) x = P p (E x).

(** The function w.X + e of points X of the world is f in frame i. *)
Definition is_in (w : vec) (e : R) (i : nat) (f : func) : Prop :=
  exists v d, holdsf f v d /\ dot v v = dot w w /\ forall x, dot w (P i x) + e = dot v x + d.

Lemma chain_ok fuel : forall i f v d,
  (forall k p sts, nth_error fs k = Some (p, sts) -> (p <= k)%nat) -> (i <= fuel)%nat -> (i <= length fs)%nat ->
  holdsf f v d ->
  exists w e, dot w w = dot v v /\ (forall x, dot w (P i x) + e = dot v x + d) /\
    forall k g, In (k, g) (chain fuel fs i f) -> is_in w e k g.
Proof.
  induction fuel as [|n IH]; intros i f v d WF Hi Hl Hf.
  - assert (i = 0)%nat as -> by lia. exists v, d. split; [reflexivity|]. split; [intros; rewrite root; reflexivity|].
    intros k g [E|[]]. injection E as <- <-. exists v, d. repeat split; try apply Hf. intros. rewrite root. reflexivity.
  - destruct i as [|j].
    + exists v, d. split; [reflexivity|]. split; [intros; rewrite root; reflexivity|].
      intros k g [E|[]]. injection E as <- <-. exists v, d. repeat split; try apply Hf. intros. rewrite root. reflexivity.
    + cbn [chain]. destruct (nth_error fs j) as [[p sts]|] eqn:N.
      2:{ apply nth_error_None in N. lia. }
      destruct (child j p sts N) as (E & HE & PE).
      destruct (up_all_ok sts E f v d HE Hf) as (v1 & d1 & H1 & N1 & X1).
      pose proof (WF _ _ _ N) as Hp.
      destruct (IH p (up_all sts f) v1 d1 WF ltac:(lia) ltac:(lia) H1) as (w & e & Nw & Xw & Hall).
      exists w, e. split; [congruence|].
      assert (X : forall x, dot w (P (S j) x) + e = dot v x + d) by (intros x; rewrite PE, Xw, X1; reflexivity).
      split; [exact X|]. intros k g [Q|Q].
      * injection Q as <- <-. exists v, d. repeat split; try apply Hf; [congruence | exact X].
      * apply Hall. exact Q.
Qed.

Lemma lookup_in i known f : lookup i known = Some f -> In (i, f) known.
Proof.
  induction known as [|[k g] rest IH]; cbn; [discriminate|].
  destruct (Nat.eqb_spec k i) as [->|_]; [|auto]. intros [= ->]. auto.
Qed.

Lemma at_frame_ok fuel w e known : (forall k g, In (k, g) known -> is_in w e k g) ->
  forall i f, at_frame fuel fs known i = Some f -> is_in w e i f.
Proof.
  intros K. induction fuel as [|n IH]; intros i f.
  - cbn [at_frame]. destruct (lookup i known) eqn:L; [|discriminate]. intros [= ->]. apply K, lookup_in, L.
  - cbn [at_frame]. destruct (lookup i known) eqn:L; [intros [= ->]; apply K, lookup_in, L|].
    destruct i as [|j]; [discriminate|]. destruct (nth_error fs j) as [[p sts]|] eqn:N; [|discriminate].
    destruct (at_frame n fs known p) as [g|] eqn:A; [|discriminate]. intros [= <-].
    destruct (IH _ _ A) as (v & d & Hf & Nv & X). destruct (child j p sts N) as (E & HE & PE).
    destruct (down_all_ok sts E g v d HE Hf) as (v1 & d1 & H1 & N1 & X1).
    exists v1, d1. split; [exact H1|]. split; [congruence|]. intros x. rewrite PE, X, X1. reflexivity.
Qed.

(** The same for a body that stands in a frame by one step. *)
Lemma body_ok w e i f st B : is_in w e i f -> holds_step st B ->
  exists v d, holdsf (down st f) v d /\ dot v v = dot w w /\ forall x, dot w (P i (B x)) + e = dot v x + d.
Proof.
  intros (v & d & Hf & Nv & X) HB. destruct (down_ok st B f v d HB Hf) as (v1 & d1 & H1 & N1 & X1).
  exists v1, d1. split; [exact H1|]. split; [congruence|]. intros x. rewrite X, X1. reflexivity.
Qed.

End AtOneTime.
